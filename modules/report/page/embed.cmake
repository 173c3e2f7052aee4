# cmake -D OUT=FILE.cpp -D NAMES=a;b -D FILES=x;y [-D HEADER=H] -P embed.cmake: the files as string constants of namespace stackmesh::page,
# which the header H declares.
if(NOT HEADER)
  set(HEADER report/page_files.h)
endif()
set(text "// Made by embed.cmake from the files of a page and of the Debian packages.\n#include \"${HEADER}\"\n\nnamespace stackmesh::page {\n")
foreach(name file IN ZIP_LISTS NAMES FILES)
  file(READ "${file}" content)
  string(APPEND text "const char* const ${name} = R\"stackmesh(${content})stackmesh\";\n")
endforeach()
string(APPEND text "}  // namespace stackmesh::page\n")
file(WRITE "${OUT}" "${text}")
