# cmake -D OUT=FILE.cpp -D NAMES=a;b -D FILES=x;y -P embed.cmake: the files as string constants of namespace stackmesh::page.
set(text "// Made by embed.cmake from the files of modules/report/page and of the Debian packages.\n#include \"report/page_files.h\"\n\nnamespace stackmesh::page {\n")
foreach(name file IN ZIP_LISTS NAMES FILES)
  file(READ "${file}" content)
  string(APPEND text "const char* const ${name} = R\"stackmesh(${content})stackmesh\";\n")
endforeach()
string(APPEND text "}  // namespace stackmesh::page\n")
file(WRITE "${OUT}" "${text}")
