# Writes the C++ file OUTPUT, which contains the texts of FILES. Relative paths in FILES are relative to FOLDER. OUTPUT defines
# NAMESPACE::file and NAMESPACE::paths, which HEADER declares. A file is named by its path in FILES, or by its last component if
# that path is absolute.
list(SORT FILES)
set(TABLE "")
foreach(FILE ${FILES})
  cmake_path(ABSOLUTE_PATH FILE BASE_DIRECTORY ${FOLDER} OUTPUT_VARIABLE PATH)
  file(READ ${PATH} TEXT)
  set(NAME ${FILE})
  if(IS_ABSOLUTE ${FILE})
    cmake_path(GET FILE FILENAME NAME)
  endif()
  string(APPEND TABLE "    {\"${NAME}\", R\"embedded(${TEXT})embedded\"},\n")
endforeach()
file(WRITE ${OUTPUT} "// Made by cmake/embed_files.cmake.
#include \"${HEADER}\"

#include <utility>

namespace ${NAMESPACE} {

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
