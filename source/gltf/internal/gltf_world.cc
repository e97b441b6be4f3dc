// SPDX-License-Identifier: MIT
#include "internal/gltf_world.hh"

#include "internal/gltf_accessor.hh"
#include "internal/gltf_environment.hh"
#include "internal/gltf_extra.hh"
#include "internal/gltf_node.hh"

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>

namespace gnomon::gltf {

using scene::World;
using scene::WorldPicture;

namespace {

constexpr const char *accessor_key = "gnomon_world_accessor";
constexpr const char *width_key = "gnomon_world_width";
constexpr const char *color_key = "gnomon_world_color";
constexpr const char *strength_key = "gnomon_world_strength";
constexpr const char *rotation_key = "gnomon_world_rotation";
constexpr std::array<std::string_view, 6> keys{world_picture_key, accessor_key, width_key,
                                               color_key,         strength_key, rotation_key};

constexpr Range index_range{0.0, std::numeric_limits<int>::max()};
/** Its square exceeds all counts of texels. */
constexpr Range width_range{1.0, 1 << 20};

class WorldImporter {
 public:
  WorldImporter(const File &file, const ReadPicture &read_picture, Warnings &warnings)
      : file_(file), read_picture_(read_picture), warnings_(warnings)
  {
  }

  /** Uses the extras, if no others are used. \a what: the thing that has them, for messages. */
  void offer(const std::string &what, const Model::Extras &extras)
  {
    if (std::none_of(extras.begin(), extras.end(), [](const auto &extra) { return is_world_extra(extra.first); })) {
      return;
    }
    if (extras.count(world_picture_key) == 0 && extras.count(accessor_key) == 0) {
      warnings_.add(what, std::string("its extras of a world have no effect without ") + world_picture_key);
    }
    else if (extras_) {
      warnings_.add(what, "its world has no effect, because " + extras_->what() + " has one");
    }
    else {
      extras_.emplace(extras, what);
    }
  }

  /** \a light: index of the image-based light, -1 if there is none */
  std::optional<World> import(int light, bool has_lamps)
  {
    if (!extras_ && light < 0) {
      return std::nullopt;
    }
    const Model::ImageLight *source = light < 0 ? nullptr : &file_.model.image_lights[std::size_t(light)];
    const std::string name = source == nullptr ? "" : label("image-based light", source->name, std::size_t(light));
    if (extras_ && source != nullptr) {
      warnings_.add(name, "has no effect, because " + extras_->what() + " has a world");
    }
    try {
      World world = extras_ ? of_extras() : of_light(*source, name, has_lamps);
      if (const std::string limited = limit_radiances(world); !limited.empty()) {
        warnings_.add("world", limited);
      }
      return world;
    }
    catch (const LeftOut &reason) {
      warnings_.add(extras_ ? extras_->what() : name, std::string("its world is left out: ") + reason.what());
      return std::nullopt;
    }
  }

 private:
  /** The world cannot be used, and the scene can. */
  struct LeftOut : std::runtime_error {
    using std::runtime_error::runtime_error;
  };

  const File &file_;
  const ReadPicture &read_picture_;
  Warnings &warnings_;
  std::optional<ExtraReader> extras_;

  World of_extras() const
  {
    World world;
    world.color = extras_->color(color_key, world.color, range_of<World>("color"));
    world.strength = extras_->number(strength_key, world.strength, range_of<World>("strength"));
    world.rotation = extras_->number(rotation_key, world.rotation, range_of<World>("rotation"));
    const std::optional<int> accessor = extras_->whole_if_any(accessor_key, index_range);
    const std::optional<int> width = extras_->whole_if_any(width_key, width_range);
    const Model::Extra *given = extras_->find(world_picture_key);
    if (given != nullptr && accessor) {
      extras_->fail(accessor_key, std::to_string(*accessor), std::string("absent beside ") + world_picture_key);
    }
    if (accessor.has_value() != width.has_value()) {
      extras_->fail(width_key, width ? std::to_string(*width) : "absent",
                    std::string(width ? "absent" : "present") + " where " + accessor_key + " is");
    }
    if (accessor) {
      world.picture = usable([&] { return picture_of_accessor(*accessor, *width); });
    }
    else if (const std::string *uri = std::get_if<std::string>(given)) {
      world.picture = usable([&] { return picture_of_file(*uri); });
    }
    else if (std::holds_alternative<std::vector<double>>(*given)) {
      world.color *= extras_->color(world_picture_key, world.color, range_of<World>("color"));
    }
    else {
      extras_->fail(world_picture_key, written(*given), "three numbers or the name of a file");
    }
    return world;
  }

  World of_light(const Model::ImageLight &light, const std::string &name, bool has_lamps) const
  {
    const Range intensities = range_of<World>("strength");
    if (!intensities.contains(light.intensity)) {
      throw LeftOut("its intensity is " + text(light.intensity) + ", and must be " + intensities.text());
    }
    const auto &[x, y, z, w] = light.rotation;
    if (!is_rotation({x, y, z, w})) {
      warnings_.add(name, "its rotation has no length and is not used");
    }
    if (has_lamps) {
      warnings_.add(name, "its values are radiances in W/(sr m2); they are not divided by 683 lm/W as those of lamps");
    }
    World world;
    world.strength = static_cast<float>(light.intensity);
    world.picture = usable([&] { return environment_picture(file_, light, name); });
    return world;
  }

  /** The picture of \a read. \throws LeftOut if it fails, or if the texels are those of no picture */
  template <typename Read>
  std::shared_ptr<const WorldPicture> usable(const Read &read) const
  {
    try {
      WorldPicture picture = read();
      if (const std::string clamped = clamp_radiances(picture); !clamped.empty()) {
        warnings_.add("world", "its picture: " + clamped);
      }
      World world;
      world.picture = std::make_shared<const WorldPicture>(std::move(picture));
      if (const std::string fault = fault_of(world); !fault.empty()) {
        throw LeftOut(fault);
      }
      return world.picture;
    }
    catch (const std::bad_alloc &) {
      throw LeftOut("there is not enough memory for its picture");
    }
    catch (const std::exception &error) {
      throw LeftOut(error.what());
    }
  }

  WorldPicture picture_of_file(const std::string &uri) const
  {
    const std::filesystem::path path = path_of_uri(file_.base, "picture", uri);
    if (!read_picture_) {
      throw Fault("picture '" + printable(uri) + '\'', "this program reads no pictures of worlds");
    }
    WorldPicture picture = read_picture_(path);
    picture.path = path.string();
    return picture;
  }

  WorldPicture picture_of_accessor(int index, int width) const
  {
    static_cast<void>(element(file_.model.accessors, index, accessor_key));
    const AccessorReader texels(file_, index, Model::ElementType::Vec3);
    const std::size_t height = texels.count() / std::size_t(width);
    if (height == 0 || height > std::size_t(width_range.max) || height * std::size_t(width) != texels.count()) {
      throw Fault(
          "accessor " + std::to_string(index),
          "its " + std::to_string(texels.count()) + " elements are not rows of " + std::to_string(width) + " texels");
    }
    WorldPicture picture{width, static_cast<int>(height), {}};
    picture.texels.reserve(texels.count());
    for (std::size_t i = 0; i < texels.count(); i++) {
      picture.texels.push_back(texels.vec3(i));
    }
    return picture;
  }
};

}  // namespace

bool is_world_extra(std::string_view key)
{
  return std::find(keys.begin(), keys.end(), key) != keys.end();
}

void import_world(const File &file, const std::vector<int> &nodes, const ReadPicture &read_picture, Warnings &warnings,
                  scene::Scene &scene)
{
  WorldImporter importer(file, read_picture, warnings);
  const Model::Scene *source = file.model.default_scene();
  if (source != nullptr) {
    for (const auto &[key, value] : source->extras) {
      if (!is_world_extra(key)) {
        warnings.add("scene", "extra '" + printable(key) + "' is unknown");
      }
    }
    importer.offer("scene", source->extras);
  }
  for (const int index : nodes) {
    const Model::Node &node = file.model.nodes[static_cast<std::size_t>(index)];
    if (!node.extras.empty()) {
      importer.offer(label("node", node.name, static_cast<std::size_t>(index)), node.extras);
    }
  }
  scene.set_world(importer.import(source == nullptr ? -1 : source->image_light, !scene.lamps().empty()));
}

}  // namespace gnomon::gltf
