// SPDX-License-Identifier: MIT
#include "internal/gltf_file.hh"

#include "internal/gltf_document.hh"
#include "internal/gltf_report.hh"
#include "memory_pages.hh"
#include "trace.hh"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>

namespace gnomon::gltf {

namespace {

using Bytes = std::vector<unsigned char>;
using ByteSpan = std::span<const unsigned char>;

static_assert(std::endian::native == std::endian::little,
              "glTF's numbers are little-endian and are copied as they are");

/** \a what: the name of the file in messages. Refuses devices and pipes, because reading one might never end. */
std::uintmax_t size_of_file(const std::filesystem::path &path, const std::string &what, std::uintmax_t size_max)
{
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    throw Fault(what,
                error && error != std::errc::no_such_file_or_directory ? error.message() : "there is no such file");
  }
  if (!std::filesystem::is_regular_file(status)) {
    throw Fault(what, "is not a file");
  }
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) {
    throw Fault(what, error.message());
  }
  if (size > size_max) {
    throw Fault(what, "is larger than " + (size_max == file_size_max ? "4 GiB" : std::to_string(size_max) + " bytes"));
  }
  return size;
}

/** \throws Fault, as size_of_file */
Bytes read_bytes(const std::filesystem::path &path, const std::string &what, std::uintmax_t size_max = file_size_max)
{
  const std::uintmax_t size = size_of_file(path, what, size_max);
  Bytes bytes;
  bytes.reserve(size + document_padding());
  memory::prefer_large_pages(bytes.data(), bytes.capacity());
  bytes.resize(size);
  std::ifstream stream(path, std::ios::binary);
  if (!stream.read(reinterpret_cast<char *>(bytes.data()), static_cast<std::streamsize>(size))) {
    throw Fault(what, "cannot be read");
  }
  return bytes;
}

std::uint32_t read_u32(ByteSpan bytes, std::size_t offset)
{
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + offset, sizeof(value));
  return value;
}

struct Chunks {
  ByteSpan json;
  ByteSpan binary;
};

constexpr std::string_view glb_magic = "glTF";

bool is_glb(ByteSpan bytes)
{
  return bytes.size() >= glb_magic.size() && std::equal(glb_magic.begin(), glb_magic.end(), bytes.begin());
}

/**
 * The JSON and BIN chunks of a .glb, in any order. Others are skipped, as glTF requires. Warns about harmless
 * violations of glTF.
 */
Chunks split_glb(ByteSpan bytes, Warnings &warnings)
{
  constexpr std::size_t file_header_size = 12;
  constexpr std::size_t chunk_header_size = 8;
  constexpr std::uint32_t json_type = 0x4E4F534A;
  constexpr std::uint32_t binary_type = 0x004E4942;
  if (bytes.size() < file_header_size + chunk_header_size) {
    throw Fault("GLB header", "the file is cut off");
  }
  if (const std::uint32_t version = read_u32(bytes, 4); version != 2) {
    throw Fault("GLB header", "version " + std::to_string(version) + " is not read, only 2");
  }
  const std::size_t length = read_u32(bytes, 8);
  if (length > bytes.size()) {
    throw Fault("GLB header", "the file is cut off: it says " + std::to_string(length) + " bytes, but has " +
                                  std::to_string(bytes.size()));
  }
  if (length < bytes.size()) {
    warnings.add("GLB header",
                 "it says " + std::to_string(length) + " bytes, and the file has " + std::to_string(bytes.size()));
  }
  std::optional<ByteSpan> json;
  std::optional<ByteSpan> binary;
  std::size_t offset = file_header_size;
  while (bytes.size() - offset >= chunk_header_size) {
    const std::size_t chunk_size = read_u32(bytes, offset);
    const std::uint32_t type = read_u32(bytes, offset + 4);
    // The header may say too few bytes. Other bytes after the end that it names are no chunks.
    if (offset >= length && type != json_type && type != binary_type) {
      break;
    }
    const std::string what = "GLB chunk at byte " + std::to_string(offset);
    offset += chunk_header_size;
    if (chunk_size > bytes.size() - offset) {
      throw Fault("GLB chunk", "runs past the end of the file");
    }
    if (chunk_size % 4 != 0) {
      warnings.add(what, "its length " + std::to_string(chunk_size) + " is not a multiple of 4");
    }
    std::optional<ByteSpan> *chunk = type == json_type ? &json : type == binary_type ? &binary : nullptr;
    if (chunk != nullptr && chunk->has_value()) {
      warnings.add(what, std::string("is a second ") + (chunk == &json ? "JSON" : "BIN") + " chunk, which is not read");
    }
    else if (chunk != nullptr) {
      *chunk = bytes.subspan(offset, chunk_size);
      if (chunk == &json && offset != file_header_size + chunk_header_size) {
        warnings.add(what, "is the JSON chunk, which must be the first");
      }
    }
    offset += chunk_size;
  }
  if (!json) {
    throw Fault("GLB", "has no JSON chunk");
  }
  if (offset < bytes.size()) {
    warnings.add("GLB", "bytes after the last chunk are not read: " + std::to_string(bytes.size() - offset));
  }
  return {*json, binary.value_or(ByteSpan())};
}

/** \throws Fault with advice if the file is one of another program or format that people have in place of glTF. */
void refuse_others(const std::filesystem::path &path, ByteSpan bytes)
{
  struct Other {
    std::string_view extension;
    std::string_view name;
    /** First bytes; empty: not known by them. */
    std::string_view magic{};
  };
  static constexpr std::array<Other, 14> others = {{{".blend", "Blender", "BLENDER"},
                                                    {".fbx", "FBX", "Kaydara FBX Binary"},
                                                    {".obj", "Wavefront OBJ"},
                                                    {".dae", "COLLADA"},
                                                    {".stl", "STL"},
                                                    {".ply", "PLY", "ply\n"},
                                                    {".abc", "Alembic", "Ogawa"},
                                                    {".usd", "USD", "PXR-USDC"},
                                                    {".usda", "USD", "#usda"},
                                                    {".usdc", "USD"},
                                                    {".usdz", "USD"},
                                                    {".3ds", "3D Studio"},
                                                    {".max", "3ds Max"},
                                                    {".ma", "Maya"}}};
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  const std::string_view first(reinterpret_cast<const char *>(bytes.data()), std::min<std::size_t>(bytes.size(), 32));
  const auto is_first = [](char c) { return c == '{' || c == ' ' || c == '\n' || c == '\r' || c == '\t'; };
  const bool is_json = !first.empty() && is_first(first.front());
  const auto pictures = {"v/1\x01", "\x89PNG", "\xff\xd8\xff", "#?RADIANCE", "#?RGBE"};
  if (std::ranges::any_of(pictures, [&](std::string_view magic) { return first.starts_with(magic); })) {
    throw Fault("file", "is a picture, and not glTF 2.0");
  }
  for (const Other &other : others) {
    const bool is_known = !other.magic.empty() && first.starts_with(other.magic);
    if (is_known || (extension == other.extension && !is_json)) {
      const bool is_blend = other.extension == ".blend";
      throw Fault("file",
                  std::string("is of the format ") + std::string(other.name) + ", and not glTF 2.0: " +
                      (is_blend ? "open it in Blender" : "import it into Blender or another program") +
                      " and export it as glTF 2.0 (in Blender: File > Export > glTF 2.0, with Cameras and Punctual "
                      "Lights included)");
    }
  }
}

/** The value of two hexadecimal digits; negative for other characters. */
int hexadecimal(std::string_view digits)
{
  int value = 0;
  for (const char digit : digits) {
    constexpr std::string_view all = "0123456789abcdef";
    const std::size_t found = all.find(static_cast<char>(digit | 0x20));
    if (found == all.npos) {
      return -1;
    }
    value = 16 * value + static_cast<int>(found);
  }
  return digits.size() == 2 ? value : -1;
}

std::string percent_decoded(std::string_view uri)
{
  std::string result;
  for (std::size_t i = 0; i < uri.size(); i++) {
    const int code = uri[i] == '%' ? hexadecimal(uri.substr(i + 1, 2)) : -1;
    result += code < 0 ? uri[i] : static_cast<char>(code);
    i += code < 0 ? 0 : 2;
  }
  return result;
}

/**
 * Empty if the text is not base64, of the alphabet for files or that for URLs (RFC 4648). Padding at the end is
 * optional. White space is skipped.
 */
std::optional<Bytes> base64_decoded(std::string_view text)
{
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  constexpr std::uint8_t none = 64;
  constexpr std::uint8_t space = 65;
  static const std::array<std::uint8_t, 256> value_of = [&] {
    std::array<std::uint8_t, 256> values;
    values.fill(none);
    for (std::size_t i = 0; i < digits.size(); i++) {
      values[static_cast<unsigned char>(digits[i])] = static_cast<std::uint8_t>(i);
    }
    values['-'] = 62;
    values['_'] = 63;
    for (const unsigned char white : {' ', '\t', '\r', '\n', '\f', '\v'}) {
      values[white] = space;
    }
    return values;
  }();
  text = text.substr(0, text.find_last_not_of("= \t\r\n\f\v") + 1);
  Bytes bytes;
  bytes.reserve(3 * text.size() / 4);
  std::uint32_t bits = 0;
  unsigned bit_count = 0;
  for (const char character : text) {
    const std::uint8_t value = value_of[static_cast<unsigned char>(character)];
    if (value >= none) {
      if (value == none) {
        return std::nullopt;
      }
      continue;
    }
    bits = bits << 6U | value;
    bit_count += 6;
    if (bit_count >= 8) {
      bit_count -= 8;
      bytes.push_back(static_cast<unsigned char>(bits >> bit_count));
    }
  }
  // One digit alone is no byte.
  return bit_count == 6 ? std::nullopt : std::optional(std::move(bytes));
}

/** Whether the texts are equal but for the case of letters of ASCII. \a lower has none in upper case. */
bool is_equal_without_case(std::string_view text, std::string_view lower)
{
  return std::ranges::equal(text, lower, [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a | 0x20 : a) == b; });
}

/** RFC 2397: `data:[type][;parameter]...[;base64],data`. */
Bytes bytes_of_data_uri(const std::string &what, std::string_view uri)
{
  const std::size_t comma = uri.find(',');
  if (comma == uri.npos) {
    throw Fault(what, "its data URI has no comma before the data");
  }
  bool is_base64 = false;
  for (std::string_view parameters = uri.substr(0, comma); parameters.find(';') != parameters.npos;) {
    parameters.remove_prefix(parameters.find(';') + 1);
    std::string_view one = parameters.substr(0, parameters.find(';'));
    one.remove_prefix(std::min(one.find_first_not_of(' '), one.size()));
    is_base64 = is_base64 || is_equal_without_case(one.substr(0, one.find_last_not_of(' ') + 1), "base64");
  }
  std::string_view data = uri.substr(comma + 1);
  std::string decoded;
  if (data.find('%') != data.npos) {
    decoded = percent_decoded(data);
    data = decoded;
  }
  if (!is_base64) {
    return {data.begin(), data.end()};
  }
  std::optional<Bytes> bytes = base64_decoded(data);
  if (!bytes) {
    throw Fault(what, "its data URI is not base64");
  }
  return std::move(*bytes);
}

/** The path of an external file, and its name in messages. */
struct FileBeside {
  std::filesystem::path path;
  std::string what;
};

bool is_below(const std::filesystem::path &path, const std::filesystem::path &folder)
{
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

FileBeside file_beside(const UriBase &base, const std::string &what, const std::string &uri)
{
  const std::string name = percent_decoded(uri);
  const std::string what_file = what + " '" + printable(name) + "'";
  if (name.empty() || name.find('\0') != name.npos || name.find("://") != name.npos ||
      std::filesystem::path(name).is_absolute()) {
    throw Fault(what_file, "is not a file beside the scene");
  }
  if (base.only_below.empty()) {
    return {base.folder / name, what_file};
  }
  // The path without links is the one that is read. A path to a missing file is refused like one to an existing file,
  // so that a document cannot detect which files exist.
  std::error_code error;
  std::filesystem::path path = std::filesystem::weakly_canonical(std::filesystem::absolute(base.folder / name), error);
  if (error || !is_below(path, base.only_below)) {
    throw Fault(what_file, "is not below the folder '" + base.only_below.string() + '\'');
  }
  return {std::move(path), what_file};
}

class BufferLoader {
 public:
  BufferLoader(File &file, ByteSpan binary_chunk) : file_(file), binary_chunk_(binary_chunk) {}

  void load(const Model::Buffer &buffer)
  {
    const std::size_t index = file_.buffers.size();
    const std::string what = "buffer " + std::to_string(index);
    ByteSpan bytes;
    if (buffer.uri) {
      bytes = is_data_uri(*buffer.uri) ? store(bytes_of_data_uri(what, *buffer.uri)) : from_file(what, *buffer.uri);
    }
    else if (index == 0 && !binary_chunk_.empty()) {
      bytes = binary_chunk_;
    }
    else {
      // Valid: an unsupported extension provides the bytes.
      file_.buffers.emplace_back();
      return;
    }
    if (buffer.byte_length > bytes.size()) {
      throw Fault(what, "is cut off: it says " + std::to_string(buffer.byte_length) + " bytes, but has " +
                            std::to_string(bytes.size()));
    }
    file_.buffers.push_back(bytes.first(buffer.byte_length));
  }

 private:
  File &file_;
  ByteSpan binary_chunk_;
  /** Files by path: a file that several buffers use is read once. */
  std::map<std::filesystem::path, ByteSpan> read_;

  ByteSpan store(Bytes bytes)
  {
    return file_.storage.emplace_back(std::move(bytes));
  }

  ByteSpan from_file(const std::string &what, const std::string &uri)
  {
    const auto [path, what_file] = file_beside(file_.base, what, uri);
    std::error_code error;
    std::filesystem::path key = std::filesystem::canonical(path, error);
    if (error) {
      key = path;
    }
    const auto [place, is_new] = read_.try_emplace(std::move(key));
    if (is_new) {
      place->second = store(read_bytes(path, what_file));
    }
    return place->second;
  }
};

}  // namespace

bool is_data_uri(const std::string &uri)
{
  return is_equal_without_case(std::string_view(uri).substr(0, 5), "data:");
}

std::vector<std::filesystem::path> files_of(const File &file)
{
  std::vector<std::filesystem::path> paths;
  const auto add = [&](const std::string &uri) {
    try {
      if (!uri.empty() && !is_data_uri(uri)) {
        paths.push_back(path_of_uri(file.base, "file", uri));
      }
    }
    catch (const Fault &) {
      // The element that needs it says so.
    }
  };
  for (const Model::Buffer &buffer : file.model.buffers) {
    add(buffer.uri.value_or(""));
  }
  for (const Model::Image &image : file.model.images) {
    add(image.uri);
  }
  for (const Model::Material &material : file.model.materials) {
    add(material.surface_uri);
  }
  const auto add_world = [&](const auto &things) {
    for (const auto &thing : things) {
      const auto found = thing.extras.find(world_picture_key);
      const auto *const uri = found == thing.extras.end() ? nullptr : std::get_if<std::string>(&found->second);
      add(uri == nullptr ? "" : *uri);
    }
  };
  add_world(file.model.scenes);
  add_world(file.model.nodes);
  return paths;
}

File load_document(const std::filesystem::path &path, Warnings &warnings)
{
  File file;
  file.storage.push_back(read_bytes(path, "file"));
  Bytes &storage = file.storage.back();
  const std::size_t size = storage.size();
  storage.resize(size + document_padding());
  const ByteSpan bytes = ByteSpan(storage).first(size);
  if (!is_glb(bytes)) {
    refuse_others(path, bytes);
  }
  const Chunks chunks = is_glb(bytes) ? split_glb(bytes, warnings) : Chunks{bytes, {}};
  file.binary = chunks.binary;
  file.model = parse_document(chunks.json, warnings);
  file.base.folder = path.parent_path();
  return file;
}

File load_file(const std::filesystem::path &path, const std::filesystem::path &only_below, Warnings &warnings)
{
  const trace::Span span("read and parse");
  File file = load_document(path, warnings);
  if (!only_below.empty()) {
    std::error_code error;
    file.base.only_below = std::filesystem::canonical(only_below, error);
    if (error || !std::filesystem::is_directory(file.base.only_below)) {
      throw Fault("folder '" + only_below.string() + '\'', "does not exist, so that no file can be below it");
    }
  }
  BufferLoader buffer_loader(file, file.binary);
  for (const Model::Buffer &buffer : file.model.buffers) {
    buffer_loader.load(buffer);
  }
  return file;
}

std::filesystem::path path_of_uri(const UriBase &base, const std::string &what, const std::string &uri)
{
  if (is_data_uri(uri)) {
    throw Fault(what, "is a data URI, and must be the name of a file");
  }
  FileBeside file = file_beside(base, what, uri);
  static_cast<void>(size_of_file(file.path, file.what, file_size_max));
  return std::move(file.path);
}

std::vector<unsigned char> bytes_of_uri(const UriBase &base, const std::string &what, const std::string &uri,
                                        std::uintmax_t size_max)
{
  if (is_data_uri(uri)) {
    return bytes_of_data_uri(what, uri);
  }
  const FileBeside file = file_beside(base, what, uri);
  return read_bytes(file.path, file.what, size_max);
}

}  // namespace gnomon::gltf
