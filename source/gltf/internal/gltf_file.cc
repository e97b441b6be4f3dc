// SPDX-License-Identifier: MIT
#include "internal/gltf_file.hh"

#include "internal/gltf_report.hh"
#include "internal/gltf_schema.hh"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <string_view>
#include <system_error>

namespace gnomon::gltf {

namespace {

using nlohmann::json;
using Bytes = std::vector<unsigned char>;
using ByteSpan = std::span<const unsigned char>;

static_assert(std::endian::native == std::endian::little,
              "glTF's numbers are little-endian and are copied as they are");

/** The largest size that a .glb can have. */
constexpr std::uintmax_t file_size_max = std::uintmax_t(4) << 30U;

/** \a what names the file in the message. Devices and pipes are refused: reading one might never end. */
Bytes read_bytes(const std::filesystem::path &path, const std::string &what)
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
  if (error || size > file_size_max) {
    throw Fault(what, error ? error.message() : "is larger than 4 GiB");
  }
  Bytes bytes(size);
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

/** The two chunks of a .glb; others are skipped, as glTF asks. */
Chunks split_glb(ByteSpan bytes)
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
  Chunks chunks;
  std::size_t offset = file_header_size;
  while (length >= offset && length - offset >= chunk_header_size) {
    const std::size_t chunk_size = read_u32(bytes, offset);
    const std::uint32_t type = read_u32(bytes, offset + 4);
    offset += chunk_header_size;
    if (chunk_size > length - offset) {
      throw Fault("GLB chunk", "runs past the end of the file");
    }
    const ByteSpan content = bytes.subspan(offset, chunk_size);
    if (type == json_type && chunks.json.empty()) {
      chunks.json = content;
    }
    else if (type == binary_type && chunks.binary.empty()) {
      chunks.binary = content;
    }
    offset += chunk_size;
  }
  if (chunks.json.empty()) {
    throw Fault("GLB", "has no JSON chunk");
  }
  return chunks;
}

json parse_json(ByteSpan bytes)
{
  try {
    return json::parse(bytes.begin(), bytes.end());
  }
  catch (const json::exception &error) {
    // "[json.exception.parse_error.101] parse error at ...": the identifier says nothing to a user.
    const std::string_view message = error.what();
    const std::size_t prefix_end = message.find("] ");
    throw Fault("JSON", printable(prefix_end == message.npos ? message : message.substr(prefix_end + 2)));
  }
}

/** A value of two hexadecimal digits, or nothing. */
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

bool is_data_uri(const std::string &uri)
{
  return uri.rfind("data:", 0) == 0;
}

Bytes bytes_of_data_uri(const std::string &what, const std::string &uri)
{
  const std::size_t comma = uri.find(',');
  constexpr std::string_view suffix = ";base64";
  if (comma == uri.npos || comma < suffix.size() || uri.compare(comma - suffix.size(), suffix.size(), suffix) != 0) {
    throw Fault(what, "its data URI is not base64");
  }
  // tinygltf knows a few media types only, and the type does not matter here.
  const std::string known = "data:application/octet-stream;base64," + uri.substr(comma + 1);
  Bytes bytes;
  std::string media_type;
  if (comma + 1 < uri.size() && !tinygltf::DecodeDataURI(&bytes, media_type, known, 0, false)) {
    throw Fault(what, "its data URI cannot be decoded");
  }
  return bytes;
}

/** A file that \a uri names, and how messages name it. */
struct FileBeside {
  std::filesystem::path path;
  std::string what;
};

FileBeside file_beside(const std::filesystem::path &folder, const std::string &what, const std::string &uri)
{
  const std::string name = percent_decoded(uri);
  const std::string what_file = what + " '" + printable(name) + "'";
  if (name.empty() || name.find('\0') != name.npos || name.find("://") != name.npos ||
      std::filesystem::path(name).is_absolute()) {
    throw Fault(what_file, "is not a file beside the scene");
  }
  return {folder / name, what_file};
}

class BufferLoader {
 public:
  BufferLoader(File &file, ByteSpan binary_chunk) : file_(file), binary_chunk_(binary_chunk) {}

  void load(const json &buffer)
  {
    const std::size_t index = file_.buffers.size();
    const std::string what = "buffer " + std::to_string(index);
    ByteSpan bytes;
    const auto uri = buffer.find("uri");
    if (uri != buffer.end()) {
      const auto &uri_text = uri->get_ref<const std::string &>();
      bytes = is_data_uri(uri_text) ? store(bytes_of_data_uri(what, uri_text)) : from_file(what, uri_text);
    }
    else if (index == 0 && !binary_chunk_.empty()) {
      bytes = binary_chunk_;
    }
    else {
      // Legal: an extension that we do not read fills it.
      file_.buffers.emplace_back();
      return;
    }
    const auto length = buffer.value("byteLength", std::uint64_t(0));
    if (length > bytes.size()) {
      throw Fault(what,
                  "is cut off: it says " + std::to_string(length) + " bytes, but has " + std::to_string(bytes.size()));
    }
    file_.buffers.push_back(bytes.first(length));
  }

 private:
  File &file_;
  ByteSpan binary_chunk_;
  /** A file that many buffers name is read once. */
  std::map<std::filesystem::path, ByteSpan> read_;

  ByteSpan store(Bytes bytes)
  {
    return file_.storage.emplace_back(std::move(bytes));
  }

  ByteSpan from_file(const std::string &what, const std::string &uri)
  {
    const auto [path, what_file] = file_beside(file_.folder, what, uri);
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

/**
 * tinygltf refuses a file in which an index accessor has no buffer view, though glTF allows that (all zeros, sparse,
 * or filled by an extension). So such accessors are lent an empty one, which is taken back afterwards.
 */
int lend_buffer_view(json &document)
{
  if (!document.contains("bufferViews")) {
    document["bufferViews"] = json::array();
  }
  json &views = document["bufferViews"];
  const auto lent = static_cast<int>(views.size());
  views.push_back({{"buffer", 0}, {"byteLength", 0}});
  if (document.contains("accessors")) {
    for (json &accessor : document["accessors"]) {
      if (!accessor.contains("bufferView")) {
        accessor["bufferView"] = lent;
      }
    }
  }
  return lent;
}

void take_back_buffer_view(tinygltf::Model &model, int lent)
{
  for (tinygltf::Accessor &accessor : model.accessors) {
    if (accessor.bufferView == lent) {
      accessor.bufferView = -1;
    }
  }
  model.bufferViews.pop_back();
}

tinygltf::Model model_from(json &document)
{
  const int lent = lend_buffer_view(document);
  const std::string pruned = document.dump();
  tinygltf::TinyGLTF loader;
  tinygltf::Model model;
  std::string error;
  std::string warning;
  if (!loader.LoadASCIIFromString(&model, &error, &warning, pruned.data(), static_cast<unsigned>(pruned.size()), "")) {
    throw Fault("glTF", printable(std::string_view(error).substr(0, error.find('\n'))));
  }
  take_back_buffer_view(model, lent);
  return model;
}

}  // namespace

File load_file(const std::filesystem::path &path)
{
  File file;
  file.storage.push_back(read_bytes(path, "file"));
  const ByteSpan bytes = file.storage.back();
  const Chunks chunks = is_glb(bytes) ? split_glb(bytes) : Chunks{bytes, {}};
  json document = parse_json(chunks.json);
  const auto animations = document.is_object() ? document.find("animations") : document.end();
  file.has_animations = animations != document.end() && !animations->empty();
  check_document(document);

  file.folder = path.parent_path();
  BufferLoader buffer_loader(file, chunks.binary);
  if (document.contains("buffers")) {
    for (const json &buffer : document["buffers"]) {
      buffer_loader.load(buffer);
    }
    // tinygltf would read them once more, and with fewer checks.
    document.erase("buffers");
  }
  if (document.contains("images")) {
    for (const json &image : document["images"]) {
      file.images.push_back({image.value("name", ""), image.value("uri", ""), image.value("bufferView", -1)});
    }
    // tinygltf would read them all.
    document.erase("images");
  }
  file.model = model_from(document);
  return file;
}

std::vector<unsigned char> bytes_of_uri(const std::filesystem::path &folder, const std::string &what,
                                        const std::string &uri)
{
  if (is_data_uri(uri)) {
    return bytes_of_data_uri(what, uri);
  }
  const FileBeside file = file_beside(folder, what, uri);
  return read_bytes(file.path, file.what);
}

}  // namespace gnomon::gltf
