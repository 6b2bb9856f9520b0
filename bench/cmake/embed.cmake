# cmake -DINPUT=<text file> -DNAME=<identifier> -DOUTPUT=<file.cpp> -P embed.cmake
# Turns a text file into the C++ string bench::NAME, in pieces that every compiler takes.
cmake_minimum_required(VERSION 3.25)
file(READ ${INPUT} text HEX)
string(REGEX MATCHALL "[0-9a-f][0-9a-f]" bytes "${text}")
list(TRANSFORM bytes PREPEND "0x")
string(REPLACE ";" "," bytes "${bytes}")
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT
"namespace bench {
extern const unsigned char @NAME@[];
extern const unsigned long @NAME@_size;
const unsigned char @NAME@[] = {@bytes@};
const unsigned long @NAME@_size = sizeof @NAME@;
}  // namespace bench
")
