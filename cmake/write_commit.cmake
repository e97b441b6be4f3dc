# Writes the header OUTPUT with the current commit of FOLDER, if the commit has changed.
execute_process(COMMAND git describe --always --dirty --abbrev=7 --exclude=* WORKING_DIRECTORY ${FOLDER}
  OUTPUT_VARIABLE COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT COMMIT)
  set(COMMIT "no commit")
endif()
set(TEXT "// Made by cmake/write_commit.cmake.\n#define GNOMON_COMMIT \"${COMMIT}\"\n")
set(BEFORE "")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} BEFORE)
endif()
if(NOT TEXT STREQUAL BEFORE)
  file(WRITE ${OUTPUT} "${TEXT}")
endif()
