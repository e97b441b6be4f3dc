# Writes a C++ file that defines shaders/shader_files.hh: FOLDER, FILES (paths below it), OUTPUT.
list(SORT FILES)
set(TABLE "")
foreach(FILE ${FILES})
  file(READ ${FOLDER}/${FILE} TEXT)
  string(APPEND TABLE "    {\"${FILE}\", R\"shader(${TEXT})shader\"},\n")
endforeach()
file(WRITE ${OUTPUT} "// Made by cmake/embed_shaders.cmake.
#include \"shader_files.hh\"

#include <utility>

namespace gnomon::shaders {

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

}  // namespace gnomon::shaders
")
