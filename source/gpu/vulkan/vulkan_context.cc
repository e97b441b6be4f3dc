// SPDX-License-Identifier: MIT
#include "vulkan_context.hh"

#include "gpu_error.hh"
#include "trace.hh"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <dlfcn.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <utility>

namespace gnomon::gpu {

namespace {

constexpr std::uint32_t api_version = VK_API_VERSION_1_3;
constexpr const char *validation_layer = "VK_LAYER_KHRONOS_validation";

/** The features that a device must have, and those of them that are used where a device has them. */
struct Features {
  VkPhysicalDeviceProvokingVertexFeaturesEXT provoking_vertex{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROVOKING_VERTEX_FEATURES_EXT, nullptr, VK_FALSE, VK_FALSE};
  VkPhysicalDeviceVulkan13Features v13{};
  VkPhysicalDeviceVulkan12Features v12{};
  VkPhysicalDeviceFeatures2 core{};

  Features()
  {
    v13.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES;
    v13.pNext = &provoking_vertex;
    v12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
    v12.pNext = &v13;
    core.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
    core.pNext = &v12;
  }
  Features(const Features &) = delete;
  Features &operator=(const Features &) = delete;

  struct Named {
    const char *name;
    VkBool32 *value;
  };
  std::vector<Named> required()
  {
    return {{"multiDrawIndirect", &core.features.multiDrawIndirect},
            {"drawIndirectFirstInstance", &core.features.drawIndirectFirstInstance},
            {"depthClamp", &core.features.depthClamp},
            {"timelineSemaphore", &v12.timelineSemaphore},
            {"hostQueryReset", &v12.hostQueryReset},
            {"dynamicRendering", &v13.dynamicRendering},
            {"synchronization2", &v13.synchronization2},
            {"provokingVertexLast", &provoking_vertex.provokingVertexLast}};
  }

  /** Sets those that \a enabled and its chain have. */
  void read(const VkPhysicalDeviceFeatures2 &enabled)
  {
    core.features = enabled.features;
    const auto set = [](VkBool32 &feature, VkBool32 value) { feature = feature | value; };
    for (auto *link = static_cast<const VkBaseInStructure *>(enabled.pNext); link; link = link->pNext) {
      const auto as = [&]<typename T>(const T & /*type*/) -> const T & { return *reinterpret_cast<const T *>(link); };
      switch (link->sType) {
        case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES: {
          const auto &chained = as(VkPhysicalDeviceVulkan12Features{});
          set(v12.timelineSemaphore, chained.timelineSemaphore);
          set(v12.hostQueryReset, chained.hostQueryReset);
          set(v12.shaderOutputLayer, chained.shaderOutputLayer);
          break;
        }
        case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES: {
          const auto &chained = as(VkPhysicalDeviceVulkan13Features{});
          set(v13.dynamicRendering, chained.dynamicRendering);
          set(v13.synchronization2, chained.synchronization2);
          break;
        }
        case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_TIMELINE_SEMAPHORE_FEATURES:
          set(v12.timelineSemaphore, as(VkPhysicalDeviceTimelineSemaphoreFeatures{}).timelineSemaphore);
          break;
        case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_HOST_QUERY_RESET_FEATURES:
          set(v12.hostQueryReset, as(VkPhysicalDeviceHostQueryResetFeatures{}).hostQueryReset);
          break;
        case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DYNAMIC_RENDERING_FEATURES:
          set(v13.dynamicRendering, as(VkPhysicalDeviceDynamicRenderingFeatures{}).dynamicRendering);
          break;
        case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SYNCHRONIZATION_2_FEATURES:
          set(v13.synchronization2, as(VkPhysicalDeviceSynchronization2Features{}).synchronization2);
          break;
        case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROVOKING_VERTEX_FEATURES_EXT:
          set(provoking_vertex.provokingVertexLast,
              as(VkPhysicalDeviceProvokingVertexFeaturesEXT{}).provokingVertexLast);
          break;
        default: break;
      }
    }
  }

  /** Names of those that are required and not set. */
  std::vector<std::string> missing()
  {
    std::vector<std::string> names;
    for (const Named &feature : required()) {
      if (*feature.value == VK_FALSE) {
        names.emplace_back(feature.name);
      }
    }
    return names;
  }
};

bool has_extension(const VulkanInstanceTable &vk, VkPhysicalDevice device, const char *name)
{
  std::uint32_t count = 0;
  vk.vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> extensions(count);
  vk.vkEnumerateDeviceExtensionProperties(device, nullptr, &count, extensions.data());
  return std::ranges::any_of(extensions, [&](const auto &e) { return std::strcmp(e.extensionName, name) == 0; });
}

std::vector<VkQueueFamilyProperties> queue_families(const VulkanInstanceTable &vk, VkPhysicalDevice device)
{
  std::uint32_t count = 0;
  vk.vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vk.vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  return families;
}

bool has_graphics(const VkQueueFamilyProperties &family)
{
  return (family.queueFlags & VK_QUEUE_GRAPHICS_BIT) != 0;
}

VkPhysicalDeviceProperties properties_of(const VulkanInstanceTable &vk, VkPhysicalDevice device)
{
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, nullptr, {}};
  vk.vkGetPhysicalDeviceProperties2(device, &properties);
  return properties.properties;
}

/** Empty, or that a device of \a version is too old. */
std::vector<std::string> missing_version(std::uint32_t version)
{
  if (version >= api_version) {
    return {};
  }
  return {fmt::format("Vulkan 1.3 (it has {}.{})", VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version))};
}

/** Devices with a greater number are preferred. */
int rank_of(VkPhysicalDeviceType type)
{
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU: return 4;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU: return 3;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU: return 2;
    case VK_PHYSICAL_DEVICE_TYPE_CPU: return 1;
    default: return 0;
  }
}

/** Entry point of Vulkan's library, which stays loaded. */
PFN_vkGetInstanceProcAddr load_loader()
{
  void *library = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
  void *loader = library ? dlsym(library, "vkGetInstanceProcAddr") : nullptr;
  if (!loader) {
    throw TransientError("Vulkan: there is no loader (libvulkan.so.1)");
  }
  return reinterpret_cast<PFN_vkGetInstanceProcAddr>(loader);
}

}  // namespace

VulkanContext::VulkanContext(bool is_debug, GLFWwindow *window, std::function<void(std::string_view message)> sink)
    : sink_(std::move(sink)), window_(window)
{
  const trace::Span span("Vulkan device");
  try {
    create_instance(is_debug);
    if (window_) {
      create_surface();
    }
    create_device();
    check_messages("Vulkan");
  }
  catch (...) {
    destroy();
    throw;
  }
}

VulkanContext::~VulkanContext()
{
  destroy();
}

VulkanContext::VulkanContext(const VulkanHost &host)
    : physical_device(host.physical_device),
      device(host.device),
      queue(host.queue),
      queue_family(host.queue_family),
      loader_(host.loader),
      instance_(host.instance),
      is_host_(true),
      lock_queue_(host.lock_queue),
      unlock_queue_(host.unlock_queue)
{
  if (!loader_ || !instance_ || !physical_device || !device || !queue) {
    throw Error(
        "Vulkan: the host's loader, instance, physical device, device "
        "or queue is missing");
  }
  load_instance();
  const VkPhysicalDeviceProperties properties = properties_of(instance, physical_device);
  std::vector<std::string> missing = missing_version(properties.apiVersion);
  const std::vector<VkQueueFamilyProperties> families = queue_families(instance, physical_device);
  if (queue_family >= families.size() || !has_graphics(families[queue_family])) {
    missing.push_back(fmt::format("graphics in the queue family {}", queue_family));
  }
  const std::string extension = VK_EXT_PROVOKING_VERTEX_EXTENSION_NAME;
  if (std::ranges::find(host.extensions, extension) == host.extensions.end()) {
    missing.push_back(extension);
  }
  Features enabled;
  if (host.features) {
    enabled.read(*host.features);
  }
  std::ranges::move(enabled.missing(), std::back_inserter(missing));
  if (!missing.empty()) {
    throw Error("Vulkan: the host's device, {}, is made without {}", properties.deviceName, fmt::join(missing, ", "));
  }
  load_device();
  describe(enabled.core.features, enabled.v12.shaderOutputLayer == VK_TRUE);
}

void VulkanContext::load_instance()
{
#define GNOMON_VULKAN_LOAD(NAME)                                                      \
  if (!(instance.NAME = instance_function<PFN_##NAME>(#NAME))) {                      \
    throw Error("Vulkan: the instance has no {}: is it made for Vulkan 1.3?", #NAME); \
  }
  GNOMON_VULKAN_INSTANCE_FUNCTIONS(GNOMON_VULKAN_LOAD)
#undef GNOMON_VULKAN_LOAD
  // Functions of extensions that not all instances enable. Otherwise, they are null.
  set_object_name_ = instance_function<PFN_vkSetDebugUtilsObjectNameEXT>("vkSetDebugUtilsObjectNameEXT");
  begin_label_ = instance_function<PFN_vkCmdBeginDebugUtilsLabelEXT>("vkCmdBeginDebugUtilsLabelEXT");
  end_label_ = instance_function<PFN_vkCmdEndDebugUtilsLabelEXT>("vkCmdEndDebugUtilsLabelEXT");
#define GNOMON_VULKAN_LOAD(NAME) surfaces.NAME = instance_function<PFN_##NAME>(#NAME);
  GNOMON_VULKAN_SURFACE_FUNCTIONS(GNOMON_VULKAN_LOAD)
#undef GNOMON_VULKAN_LOAD
}

void VulkanContext::load_device()
{
#define GNOMON_VULKAN_LOAD(NAME)                                                                \
  if (!(vk.NAME = reinterpret_cast<PFN_##NAME>(instance.vkGetDeviceProcAddr(device, #NAME)))) { \
    throw Error("Vulkan: the device has no {}: is the instance made for Vulkan 1.3?", #NAME);   \
  }
  GNOMON_VULKAN_DEVICE_FUNCTIONS(GNOMON_VULKAN_LOAD)
#undef GNOMON_VULKAN_LOAD
#define GNOMON_VULKAN_LOAD(NAME) \
  swapchains.NAME = reinterpret_cast<PFN_##NAME>(instance.vkGetDeviceProcAddr(device, #NAME));
  GNOMON_VULKAN_SWAPCHAIN_FUNCTIONS(GNOMON_VULKAN_LOAD)
#undef GNOMON_VULKAN_LOAD
}

VkResult VulkanContext::submit(const VkSubmitInfo2 &info)
{
  if (lock_queue_) {
    lock_queue_();
  }
  const VkResult result = vk.vkQueueSubmit2(queue, 1, &info, VK_NULL_HANDLE);
  if (unlock_queue_) {
    unlock_queue_();
  }
  return result;
}

void VulkanContext::destroy()
{
  if (is_host_) {
    return;
  }
  // Without the function, the device or the instance could not be loaded.
  if (vk.vkDestroyDevice) {
    vk.vkDestroyDevice(device, nullptr);
  }
  for (const std::string &message : take_messages()) {
    sink_(fmt::format("the validation layers report: {}", message));
  }
  if (messenger_ != VK_NULL_HANDLE) {
    instance_function<PFN_vkDestroyDebugUtilsMessengerEXT>("vkDestroyDebugUtilsMessengerEXT")(instance_, messenger_,
                                                                                              nullptr);
  }
  if (surface != VK_NULL_HANDLE) {
    surfaces.vkDestroySurfaceKHR(instance_, surface, nullptr);
  }
  if (instance.vkDestroyInstance) {
    instance.vkDestroyInstance(instance_, nullptr);
  }
}

void VulkanContext::create_instance(bool is_debug)
{
  loader_ = load_loader();
  const VkApplicationInfo application{
      VK_STRUCTURE_TYPE_APPLICATION_INFO, nullptr, "gnomon", 0, "gnomon", 0, api_version};
  VkInstanceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
  info.pApplicationInfo = &application;
  constexpr VkValidationFeatureEnableEXT synchronisation = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  VkValidationFeaturesEXT validation{};
  validation.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT;
  validation.enabledValidationFeatureCount = 1;
  validation.pEnabledValidationFeatures = &synchronisation;
  std::vector<const char *> extensions;
  if (is_debug) {
    info.pNext = &validation;
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &validation_layer;
    extensions = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};
  }
  // RenderDoc and other layers show names. They offer the extension where no driver does.
  const bool has_optional_names =
      !is_debug && (std::getenv("ENABLE_VULKAN_RENDERDOC_CAPTURE") || std::getenv("VK_INSTANCE_LAYERS"));
  if (has_optional_names) {
    extensions = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME};
  }
  if (window_) {
    std::uint32_t count = 0;
    const char **names = glfwGetRequiredInstanceExtensions(&count);
    if (!names) {
      throw TransientError("Vulkan: there is no driver that presents to windows");
    }
    extensions.insert(extensions.end(), names, names + count);
  }
  info.enabledExtensionCount = std::uint32_t(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  const auto create = instance_function<PFN_vkCreateInstance>("vkCreateInstance");
  VkResult result = create(&info, nullptr, &instance_);
  if (result == VK_ERROR_EXTENSION_NOT_PRESENT && has_optional_names) {
    // The extension of the names is the first one.
    info.enabledExtensionCount--;
    info.ppEnabledExtensionNames++;
    result = create(&info, nullptr, &instance_);
  }
  if (result == VK_ERROR_LAYER_NOT_PRESENT) {
    throw Error("Vulkan: the validation layers are not installed ({})", validation_layer);
  }
  check(result, "Vulkan");
  load_instance();
  if (is_debug) {
    VkDebugUtilsMessengerCreateInfoEXT messenger{};
    messenger.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
    messenger.messageSeverity =
        VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
    messenger.pfnUserCallback = &VulkanContext::receive_message;
    messenger.pUserData = this;
    check(instance_function<PFN_vkCreateDebugUtilsMessengerEXT>("vkCreateDebugUtilsMessengerEXT")(instance_, &messenger,
                                                                                                  nullptr, &messenger_),
          "Vulkan");
  }
}

void VulkanContext::create_surface()
{
  const VkResult result = glfwCreateWindowSurface(instance_, window_, nullptr, &surface);
  if (result != VK_SUCCESS) {
    surface = VK_NULL_HANDLE;
    throw TransientError("Vulkan: the window has no surface: VkResult {}", int(result));
  }
}

void VulkanContext::make_surface_anew()
{
  surfaces.vkDestroySurfaceKHR(instance_, std::exchange(surface, VK_NULL_HANDLE), nullptr);
  create_surface();
  if (!can_present(physical_device, queue_family)) {
    throw TransientError("Vulkan: the device cannot present to the new surface of the window");
  }
}

bool VulkanContext::can_present(VkPhysicalDevice candidate, std::uint32_t family)
{
  VkBool32 is_supported = VK_TRUE;
  if (window_) {
    check(surfaces.vkGetPhysicalDeviceSurfaceSupportKHR(candidate, family, surface, &is_supported),
          "Vulkan: the window");
  }
  return is_supported == VK_TRUE;
}

std::uint32_t VulkanContext::usable_family(VkPhysicalDevice candidate)
{
  const std::vector<VkQueueFamilyProperties> families = queue_families(instance, candidate);
  std::uint32_t family = 0;
  while (family < families.size() && !(has_graphics(families[family]) && can_present(candidate, family))) {
    family++;
  }
  return family;
}

std::vector<std::string> VulkanContext::missing_in(VkPhysicalDevice candidate,
                                                   const VkPhysicalDeviceProperties &properties)
{
  std::vector<std::string> missing = missing_version(properties.apiVersion);
  if (!missing.empty()) {
    return missing;
  }
  if (usable_family(candidate) == queue_families(instance, candidate).size()) {
    missing.emplace_back(window_ ? "a queue that draws and presents to the window" : "a queue for graphics");
  }
  if (!has_extension(instance, candidate, VK_EXT_PROVOKING_VERTEX_EXTENSION_NAME)) {
    missing.emplace_back(VK_EXT_PROVOKING_VERTEX_EXTENSION_NAME);
  }
  if (window_ && !has_extension(instance, candidate, VK_KHR_SWAPCHAIN_EXTENSION_NAME)) {
    missing.emplace_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
  }
  Features features;
  instance.vkGetPhysicalDeviceFeatures2(candidate, &features.core);
  std::ranges::move(features.missing(), std::back_inserter(missing));
  return missing;
}

void VulkanContext::create_device()
{
  std::uint32_t count = 0;
  check(instance.vkEnumeratePhysicalDevices(instance_, &count, nullptr), "Vulkan");
  std::vector<VkPhysicalDevice> devices(count);
  check(instance.vkEnumeratePhysicalDevices(instance_, &count, devices.data()), "Vulkan");
  std::vector<std::string> refused;
  int rank = -1;
  for (VkPhysicalDevice candidate : devices) {
    const VkPhysicalDeviceProperties properties = properties_of(instance, candidate);
    const std::vector<std::string> missing = missing_in(candidate, properties);
    if (!missing.empty()) {
      refused.push_back(fmt::format("{} lacks {}", properties.deviceName, fmt::join(missing, ", ")));
    }
    else if (rank_of(properties.deviceType) > rank) {
      rank = rank_of(properties.deviceType);
      physical_device = candidate;
    }
  }
  if (physical_device == VK_NULL_HANDLE) {
    throw TransientError("Vulkan: {}",
                         refused.empty() ? "there is no device" : fmt::format("{}", fmt::join(refused, "; ")));
  }
  queue_family = usable_family(physical_device);

  Features present;
  instance.vkGetPhysicalDeviceFeatures2(physical_device, &present.core);
  Features used;
  for (const Features::Named &feature : used.required()) {
    *feature.value = VK_TRUE;
  }
  used.core.features.geometryShader = present.core.features.geometryShader;
  used.core.features.fillModeNonSolid = present.core.features.fillModeNonSolid;
  used.core.features.samplerAnisotropy = present.core.features.samplerAnisotropy;
  used.v12.shaderOutputLayer = present.v12.shaderOutputLayer;

  const float priority = 1.0F;
  VkDeviceQueueCreateInfo queues{};
  queues.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
  queues.queueFamilyIndex = queue_family;
  queues.queueCount = 1;
  queues.pQueuePriorities = &priority;
  std::vector<const char *> extensions = {VK_EXT_PROVOKING_VERTEX_EXTENSION_NAME};
  if (window_) {
    extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
  }
  VkDeviceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
  info.pNext = &used.core;
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queues;
  info.enabledExtensionCount = std::uint32_t(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  check(instance.vkCreateDevice(physical_device, &info, nullptr, &device),
        fmt::format("Vulkan: {}", properties_of(instance, physical_device).deviceName));
  load_device();
  vk.vkGetDeviceQueue(device, queue_family, 0, &queue);
  describe(used.core.features, used.v12.shaderOutputLayer == VK_TRUE);
}

void VulkanContext::describe(const VkPhysicalDeviceFeatures &enabled, bool has_layer_output)
{
  has_geometry_shader = enabled.geometryShader == VK_TRUE;
  has_wireframe = enabled.fillModeNonSolid == VK_TRUE;
  has_anisotropy = enabled.samplerAnisotropy == VK_TRUE;
  has_vertex_layer = has_layer_output;
  timestamp_bits = int(queue_families(instance, physical_device)[queue_family].timestampValidBits);
  VkPhysicalDeviceDriverProperties driver{};
  driver.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES;
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &driver, {}};
  instance.vkGetPhysicalDeviceProperties2(physical_device, &properties);
  limits = properties.properties.limits;
  is_software = properties.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
  const std::uint32_t version = properties.properties.apiVersion;
  description = fmt::format("Vulkan {}.{}.{}, {} ({} {})", VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version),
                            VK_API_VERSION_PATCH(version), properties.properties.deviceName, driver.driverName,
                            driver.driverInfo);
}

VkBool32 VKAPI_PTR VulkanContext::receive_message(VkDebugUtilsMessageSeverityFlagBitsEXT /*severity*/,
                                                  VkDebugUtilsMessageTypeFlagsEXT /*types*/,
                                                  const VkDebugUtilsMessengerCallbackDataEXT *data, void *user)
{
  // A framebuffer may have fewer colours than a program writes. Vulkan discards these values, which later versions of
  // the layers warn of.
  constexpr std::string_view unused_color = "Undefined-Value-ShaderOutputNotConsumed-DynamicRendering";
  const std::string_view id = data->pMessageIdName ? data->pMessageIdName : "";
  if (id == unused_color) {
    return VK_FALSE;
  }
  // Exceptions must not propagate through the driver, so messages are stored until check_messages().
  auto *context = static_cast<VulkanContext *>(user);
  const std::scoped_lock lock(context->messages_mutex_);
  // Later versions of the layers leave the id out of the text.
  const std::string_view text = data->pMessage;
  context->messages_.push_back(text.find(id) == text.npos ? fmt::format("{}: {}", id, text) : std::string(text));
  return VK_FALSE;
}

std::vector<std::string> VulkanContext::take_messages()
{
  const std::scoped_lock lock(messages_mutex_);
  return std::exchange(messages_, {});
}

void VulkanContext::check(VkResult result, std::string_view what)
{
  note_lost(result);
  switch (result) {
    case VK_ERROR_DEVICE_LOST: check_lost(what); break;
    case VK_ERROR_OUT_OF_HOST_MEMORY:
    case VK_ERROR_OUT_OF_DEVICE_MEMORY: throw TransientError("{}: the driver is out of memory", what);
    case VK_ERROR_INCOMPATIBLE_DRIVER: throw TransientError("{}: there is no driver", what);
    default:
      if (result < 0) {
        throw Error("{}: the driver reports VkResult {}", what, int(result));
      }
  }
}

void VulkanContext::check_lost(std::string_view what) const
{
  if (is_lost_) {
    throw DeviceLost("{}: the Vulkan device is lost; create a new device", what);
  }
}

void VulkanContext::check_messages(std::string_view what)
{
  check_lost(what);
  const std::vector<std::string> messages = take_messages();
  if (!messages.empty()) {
    throw Error("{}: the validation layers report: {}", what, fmt::join(messages, "; "));
  }
}

void VulkanContext::label_object(VkObjectType type, std::uint64_t handle, const std::string &name)
{
  if (set_object_name_) {
    const VkDebugUtilsObjectNameInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT, nullptr, type, handle,
                                             name.c_str()};
    set_object_name_(device, &info);
  }
}

void VulkanContext::begin_label(VkCommandBuffer commands, std::string_view name) const
{
  if (begin_label_) {
    const std::string text(name);
    const VkDebugUtilsLabelEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT, nullptr, text.c_str(), {}};
    begin_label_(commands, &info);
  }
}

void VulkanContext::end_label(VkCommandBuffer commands) const
{
  if (end_label_) {
    end_label_(commands);
  }
}

}  // namespace gnomon::gpu
