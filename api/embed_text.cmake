# Writes the C++ source OUTPUT, which defines `const std::string& quicksand::FUNCTION()` returning the text of INPUT.
# Run with cmake -DINPUT=… -DOUTPUT=… -DFUNCTION=… -P embed_text.cmake
file(READ "${INPUT}" text)
# Adjacent raw literals of bounded length: compilers limit the length of one.
set(literals "")
string(LENGTH "${text}" length)
set(position 0)
while(position LESS length)
  string(SUBSTRING "${text}" ${position} 8000 piece)
  string(APPEND literals "R\"quicksand(${piece})quicksand\"\n")
  math(EXPR position "${position} + 8000")
endwhile()
file(WRITE "${OUTPUT}" "#include <string>\n\nnamespace quicksand {\nconst std::string& ${FUNCTION}();\n"
  "const std::string& ${FUNCTION}() {\n  static const std::string text =\n${literals};\n  return text;\n}\n"
  "}  // namespace quicksand\n")
