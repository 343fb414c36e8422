# Writes the C++ source OUTPUT, which defines `quicksand::engine_build()`: a fingerprint of the sources in FOLDER and of
# the text ALSO. The same sources give the same one, wherever they lie.
# Run with cmake -DFOLDER=… -DALSO=… -DOUTPUT=… -P hash_sources.cmake
file(GLOB_RECURSE sources RELATIVE "${FOLDER}" "${FOLDER}/*.cpp" "${FOLDER}/*.hpp" "${FOLDER}/CMakeLists.txt")
list(SORT sources)
set(sums "${ALSO}")
foreach(source IN LISTS sources)
  file(SHA256 "${FOLDER}/${source}" sum)
  string(APPEND sums "\n${source} ${sum}")
endforeach()
string(SHA256 build "${sums}")
string(SUBSTRING "${build}" 0 16 build)
file(WRITE "${OUTPUT}" "#include \"engine/run/engine_build.hpp\"\n\nnamespace quicksand {\n"
  "const char* engine_build() { return \"${build}\"; }\n}  // namespace quicksand\n")
