# gnomon_check_shaders(TARGET NAME FILES FILE... [SHADER_TARGET TARGET] [INCLUDE_FOLDERS FOLDER...] [DEFINES NAME[=VALUE]...]
#                      [OPTIONS OPTION...] [OUTPUT_FOLDER FOLDER] [STRUCTS HEADER:NAME[=BLOCK[.MEMBER]]...])
#
# Checks shaders by `gnomon shaders check` at build time: once, and again when a shader, a file that it includes, or the program
# gnomon has changed. An error fails the build with file and line. Generator expressions are refused.
#
# TARGET: a target of the project, which then depends on the check, or the name of a new one that is a part of `all`.
# FILES: files whose names differ in the stage only are one program. Paths are relative to the current source folder.
# SHADER_TARGET: vulkan1.0 to vulkan1.3, opengl, opengl-spirv, es; by default as each program says.
# OPTIONS: others of `gnomon shaders check`, such as -Werror.
# OUTPUT_FOLDER: gets NAME.STAGE.spv for each file, for targets with SPIR-V. Relative to the current build folder. Two files of one name need
# two folders.
# STRUCTS: C++ structs as TARGET, a library or program, includes them: it does not compile where one has another layout than its block.
function(gnomon_check_shaders)
  cmake_parse_arguments(PARSE_ARGV 0 CHECK "" "TARGET;SHADER_TARGET;OUTPUT_FOLDER" "FILES;INCLUDE_FOLDERS;DEFINES;OPTIONS;STRUCTS")
  if(NOT CHECK_TARGET OR NOT CHECK_FILES OR CHECK_UNPARSED_ARGUMENTS OR CHECK_KEYWORDS_MISSING_VALUES)
    message(FATAL_ERROR "gnomon_check_shaders: TARGET and FILES are needed; unknown: '${CHECK_UNPARSED_ARGUMENTS}'; without a value: "
      "'${CHECK_KEYWORDS_MISSING_VALUES}'")
  endif()
  if("${ARGN}" MATCHES "\\$<")
    message(FATAL_ERROR "gnomon_check_shaders: generator expressions are not evaluated: '${ARGN}'")
  endif()
  # The program of the package that was found comes first, also where another one was found before.
  find_program(GNOMON_CHECK_PROGRAM gnomon PATHS ${GNOMON_PROGRAM_FOLDER} NO_DEFAULT_PATH NO_CACHE)
  find_program(GNOMON_CHECK_PROGRAM gnomon NO_CACHE REQUIRED)
  set(SOURCE_OPTIONS "")
  if(CHECK_SHADER_TARGET)
    list(APPEND SOURCE_OPTIONS --target ${CHECK_SHADER_TARGET})
  endif()
  foreach(FOLDER IN LISTS CHECK_INCLUDE_FOLDERS)
    cmake_path(ABSOLUTE_PATH FOLDER)
    list(APPEND SOURCE_OPTIONS -I ${FOLDER})
  endforeach()
  foreach(DEFINE IN LISTS CHECK_DEFINES)
    list(APPEND SOURCE_OPTIONS -D ${DEFINE})
  endforeach()
  set(OPTIONS ${CHECK_OPTIONS} ${SOURCE_OPTIONS})
  if(CHECK_OUTPUT_FOLDER)
    cmake_path(ABSOLUTE_PATH CHECK_OUTPUT_FOLDER BASE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
    file(MAKE_DIRECTORY ${CHECK_OUTPUT_FOLDER})
    list(APPEND OPTIONS -o ${CHECK_OUTPUT_FOLDER})
  endif()

  set(FILES "")
  set(PROGRAMS "")
  foreach(FILE IN LISTS CHECK_FILES)
    cmake_path(ABSOLUTE_PATH FILE)
    list(APPEND FILES ${FILE})
    # As the program groups files: NAME.vert, NAME.vert.glsl and NAME_vert.glsl.
    string(REGEX REPLACE "[._](vert|tesc|tese|geom|task|mesh|frag|comp|rgen|rint|rahit|rchit|rmiss|rcall)(\\.glsl)?$" "" PROGRAM ${FILE})
    string(SHA256 KEY ${PROGRAM})
    if(NOT DEFINED FILES_${KEY})
      list(APPEND PROGRAMS ${PROGRAM})
      set(FILES_${KEY} "")
    endif()
    list(APPEND FILES_${KEY} ${FILE})
  endforeach()

  set(FOLDER ${CMAKE_CURRENT_BINARY_DIR}/${CHECK_TARGET}.shaders)
  file(MAKE_DIRECTORY ${FOLDER})
  set(STAMPS "")
  foreach(PROGRAM IN LISTS PROGRAMS)
    string(SHA256 KEY ${PROGRAM})
    cmake_path(GET PROGRAM FILENAME NAME)
    string(SUBSTRING ${KEY} 0 8 NUMBER)
    set(STAMP ${FOLDER}/${NAME}.${NUMBER}.checked)
    set(SPIRV "")
    if(CHECK_OUTPUT_FOLDER)
      foreach(FILE IN LISTS FILES_${KEY})
        cmake_path(GET FILE FILENAME FILE_NAME)
        list(APPEND SPIRV ${CHECK_OUTPUT_FOLDER}/${FILE_NAME}.spv)
      endforeach()
      # Ninja could not read its build file again after two rules for one file.
      get_property(WRITTEN GLOBAL PROPERTY GNOMON_SPIRV_FILES)
      foreach(FILE IN LISTS SPIRV)
        if(FILE IN_LIST WRITTEN)
          message(FATAL_ERROR "gnomon_check_shaders: ${FILE} is written twice; give the shaders of one name other folders by OUTPUT_FOLDER")
        endif()
        list(APPEND WRITTEN ${FILE})
      endforeach()
      set_property(GLOBAL PROPERTY GNOMON_SPIRV_FILES ${WRITTEN})
    endif()
    add_custom_command(OUTPUT ${STAMP} BYPRODUCTS ${SPIRV} DEPENDS ${FILES_${KEY}} ${GNOMON_CHECK_PROGRAM} DEPFILE ${STAMP}.d
      COMMAND ${GNOMON_CHECK_PROGRAM} shaders check ${FILES_${KEY}} ${OPTIONS} -MD -MF ${STAMP}.d -MT ${STAMP}
      COMMAND ${CMAKE_COMMAND} -E touch ${STAMP}
      COMMENT "Checking shaders of ${NAME}" VERBATIM)
    list(APPEND STAMPS ${STAMP})
  endforeach()
  if(CHECK_STRUCTS)
    if(NOT TARGET ${CHECK_TARGET})
      message(FATAL_ERROR "gnomon_check_shaders: STRUCTS needs a library or program as TARGET")
    endif()
    set(STRUCT_OPTIONS "")
    foreach(STRUCT IN LISTS CHECK_STRUCTS)
      list(APPEND STRUCT_OPTIONS --struct ${STRUCT})
    endforeach()
    # After the checks, whose messages are those of the shaders, and which find the files that are included.
    set(LAYOUTS ${FOLDER}/layouts.cc)
    add_custom_command(OUTPUT ${LAYOUTS} DEPENDS ${STAMPS}
      COMMAND ${GNOMON_CHECK_PROGRAM} shaders layout ${FILES} ${SOURCE_OPTIONS} ${STRUCT_OPTIONS} > ${LAYOUTS}
      COMMENT "Writing the layouts of blocks for ${CHECK_TARGET}" VERBATIM)
    target_sources(${CHECK_TARGET} PRIVATE ${LAYOUTS})
    target_include_directories(${CHECK_TARGET} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
  endif()
  if(TARGET ${CHECK_TARGET})
    add_custom_target(${CHECK_TARGET}_shaders DEPENDS ${STAMPS})
    add_dependencies(${CHECK_TARGET} ${CHECK_TARGET}_shaders)
  else()
    add_custom_target(${CHECK_TARGET} ALL DEPENDS ${STAMPS})
  endif()
endfunction()
