// SPDX-License-Identifier: MIT
#include "python_renderer.hh"

#include "gpu_create_device.hh"
#include "gpu_read.hh"
#ifdef GNOMON_PYTHON_VULKAN
#include "shader_check_spirv.hh"
#endif

#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <set>

namespace gnomon::python {

namespace {

/** \throws gpu::Error if this process is not \a process, from which it was forked */
void check_process(pid_t process)
{
  if (::getpid() != process) {
    throw gpu::Error(
        "this process was forked from one that had made a device, whose driver does not work in a forked "
        "child: start processes by spawn, as multiprocessing.get_context(\"spawn\") does");
  }
}

std::unique_ptr<gpu::Device> make_device(const std::string &backend, bool is_host)
{
  if (std::ranges::find(gpu::drawing_backend_names, backend) == gpu::drawing_backend_names.end()) {
    throw std::invalid_argument(
        fmt::format("backend: '{}' is none of {}", backend, fmt::join(gpu::drawing_backend_names, ", ")));
  }
  // Before the device, because a driver starts threads also where it fails.
  static const pid_t first_process = ::getpid();
  check_process(first_process);
  gpu::DeviceDesc desc{.backend = gpu::backend_of(backend), .shader_cache_folder = gpu::default_shader_cache_folder()};
#ifdef GNOMON_PYTHON_VULKAN
  desc.compile_spirv = shader_check::compile_spirv;
#endif
  if (is_host) {
    desc.host = gpu::GlHost{};
  }
  return gpu::create_device(desc);
}

}  // namespace

Device::Device(const std::string &backend, bool is_host) : is_host_(is_host), device_(make_device(backend, is_host)) {}

Device::~Device()
{
  if (!device_ || (is_at_home() && !is_host_)) {
    return;
  }
  // Its context cannot be current here, or need not be: a host's may be gone. Not to free it is the lesser harm, and
  // none in a forked child.
  if (::getpid() == process_ && !is_host_) {
    std::fputs("gnomon: a device is not freed, because the last reference to it is dropped on another thread\n",
               stderr);
  }
  static_cast<void>(device_.release());
  static_cast<void>(new std::vector<std::shared_ptr<void>>(std::move(left_)));
}

bool Device::is_at_home() const
{
  return std::this_thread::get_id() == thread_ && ::getpid() == process_;
}

/** Sets Device::is_drawing as long as it exists. */
class Drawing {
 public:
  explicit Drawing(Device &device) : device_(device)
  {
    device_.is_drawing = true;
  }
  ~Drawing()
  {
    device_.is_drawing = false;
  }
  Drawing(const Drawing &) = delete;
  Drawing &operator=(const Drawing &) = delete;

 private:
  Device &device_;
};

gpu::Device &Device::use()
{
  check_process(process_);
  if (std::this_thread::get_id() != thread_) {
    throw gpu::Error("the device was made on another thread, and can be used only there");
  }
  if (is_drawing) {
    throw gpu::Error("the device is drawing");
  }
  if (!device_) {
    throw gpu::Error("the device was freed");
  }
  const std::lock_guard lock(mutex_);
  if (!left_.empty()) {
    // Throws if the host's context is not current.
    device_->finish();
    left_.clear();
  }
  return *device_;
}

void Device::dispose(std::shared_ptr<void> resources)
{
  if (!is_at_home() || is_drawing || is_host_) {
    const std::lock_guard lock(mutex_);
    left_.push_back(std::move(resources));
  }
}

void Device::free()
{
  gpu::Device &device = use();
  if (renderer_count != 0) {
    throw gpu::Error(fmt::format("the device cannot be freed: it has {} renderers", renderer_count.load()));
  }
  device.finish();
  device_.reset();
}

Renderer::Renderer(std::shared_ptr<Device> device, ScenePtr scene, glm::ivec2 size_px, const eevee::Settings &settings)
    : device_(std::move(device))
{
  gpu::Device &used = device_->use();
  const scene::Scene &drawn = scene->scene;
  state_ = std::shared_ptr<State>(new State{std::move(scene), {used, drawn, size_px, settings}});
  device_->renderer_count++;
}

Renderer::~Renderer()
{
  device_->dispose(std::move(state_));
  device_->renderer_count--;
}

eevee::SceneRenderer &Renderer::use()
{
  device_->use();
  return state_->renderer;
}

std::vector<glm::vec4> Renderer::render(const scene::PlacedCamera &camera, const eevee::DrawLimits &limits)
{
  eevee::SceneRenderer &renderer = use();
  if (settings().sample_count == 0 && !std::isfinite(limits.seconds_max)) {
    throw gpu::Error("renderer: neither sample_count nor seconds_max limits the samples of the picture");
  }
  const Drawing drawing(*device_);
  const auto start = std::chrono::steady_clock::now();
  renderer.sync();
  samples_drawn_ = renderer.draw(camera, limits);
  renderer.viewport().device().finish();
  frame_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return renderer.read_picture();
}

Layers Renderer::render_layers(const scene::PlacedCamera &camera, const eevee::DrawLimits &limits,
                               const LayerRequest &request)
{
  const int sample_count = settings().sample_count;
  if (sample_count == 0 || settings().noise_threshold != 0.0F) {
    throw gpu::Error("renderer: layers need a sample_count other than 0 and a noise_threshold of 0");
  }
  Layers layers;
  layers.picture = render(camera, limits);
  if (samples_drawn_ < sample_count) {
    return layers;
  }
  eevee::SceneRenderer &renderer = use();
  const Drawing drawing(*device_);
  if (request.has_light) {
    std::set<std::string> names;
    for (const scene::PlacedLamp &lamp : renderer.render_scene().lamps()) {
      names.insert(lamp.name);
    }
    for (const std::string &name : names) {
      layers.light.emplace_back(name, eevee::render_lamp_layer(renderer, camera, sample_count, name));
    }
  }
  if (request.has_emission) {
    layers.emission =
        eevee::render_light_layer(renderer, camera, sample_count, {eevee::LightComponent::Kind::Emission});
  }
  // It comes after those that leave it out, as in the program.
  if (request.has_world) {
    layers.world = eevee::render_light_layer(renderer, camera, sample_count, {eevee::LightComponent::Kind::World});
  }
  layers.surfaces = eevee::render_surface_layers(renderer, camera, sample_count, request.surfaces);
  return layers;
}

bool Renderer::draw(const scene::PlacedCamera &camera, double seconds, const draw::Target &target)
{
  device_->use();
  const Drawing drawing(*device_);
  const bool is_complete = state_->renderer.draw_within(seconds, camera, target);
  samples_drawn_ = state_->renderer.budget_report().samples_drawn;
  frame_seconds_ = state_->renderer.budget_report().seconds;
  return is_complete;
}

std::pair<std::vector<glm::vec4>, bool> Renderer::refine(const scene::PlacedCamera &camera, double seconds)
{
  const bool is_complete = draw(camera, seconds, {});
  eevee::SceneRenderer &renderer = state_->renderer;
  if (!renderer.budget_report().is_new) {
    return {{}, is_complete};
  }
  if (renderer.budget_report().kind != eevee::BudgetReport::Kind::Preview) {
    return {renderer.read_picture(), is_complete};
  }
  gpu::Device &device = renderer.viewport().device();
  const glm::ivec2 size = size_px();
  std::optional<draw::TargetTexture> &shown = state_->shown;
  if (!shown || glm::ivec2(shown->texture().desc().width, shown->texture().desc().height) != size) {
    shown.emplace(device, "refined", gpu::Format::RGBA32F, size);
  }
  draw::Target target = shown->target();
  target.encoding = draw::Encoding::SceneLinear;
  renderer.write_shown(target);
  return {gpu::read_as<glm::vec4>(device, shown->texture()), is_complete};
}

Report Renderer::report()
{
  eevee::Report report = use().inspect().report();
  return {std::move(report.warnings), std::move(report.limits), samples_drawn_, frame_seconds_,
          device_->use().memory_bytes()};
}

}  // namespace gnomon::python
