# Writes the header OUTPUT with the define NAME: a hash of the contents of FILES.
set(CONTENTS "")
foreach(FILE IN LISTS FILES)
  file(SHA256 ${FILE} HASH)
  string(APPEND CONTENTS ${HASH})
endforeach()
string(SHA256 HASH "${CONTENTS}")
file(WRITE ${OUTPUT} "// Made by cmake/write_hash.cmake.\n#define ${NAME} \"${HASH}\"\n")
