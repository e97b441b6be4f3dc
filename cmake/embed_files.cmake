# Writes the C++ file OUTPUT, which contains FILES: the bytes of those that end with .bin, the texts of the others. Relative paths in
# FILES are relative to FOLDER. OUTPUT defines NAMESPACE::file and NAMESPACE::paths, which HEADER declares. A file is named by its
# path in FILES, or by its last component if that path is absolute.
list(SORT FILES)
set(TABLE "")
foreach(FILE ${FILES})
  cmake_path(ABSOLUTE_PATH FILE BASE_DIRECTORY ${FOLDER} OUTPUT_VARIABLE PATH)
  set(NAME ${FILE})
  if(IS_ABSOLUTE ${FILE})
    cmake_path(GET FILE FILENAME NAME)
  endif()
  if(FILE MATCHES "\\.bin$")
    file(READ ${PATH} BYTES HEX)
    string(REGEX REPLACE "(..)" "\\\\x\\1" BYTES "${BYTES}")
    string(APPEND TABLE "    {\"${NAME}\", \"${BYTES}\"sv},\n")
  else()
    file(READ ${PATH} TEXT)
    string(APPEND TABLE "    {\"${NAME}\", R\"embedded(${TEXT})embedded\"},\n")
  endif()
endforeach()
file(WRITE ${OUTPUT} "// Made by cmake/embed_files.cmake.
#include \"${HEADER}\"

#include <utility>

namespace ${NAMESPACE} {

using namespace std::string_view_literals;

static constexpr std::pair<std::string_view, std::string_view> FILES[] = {
${TABLE}};

std::optional<std::string_view> file(std::string_view path)
{
  for (const auto &[name, text] : FILES) {
    if (name == path) {
      return text;
    }
  }
  return std::nullopt;
}

std::vector<std::string_view> paths()
{
  std::vector<std::string_view> names;
  for (const auto &[name, text] : FILES) {
    names.push_back(name);
  }
  return names;
}

}  // namespace ${NAMESPACE}
")
