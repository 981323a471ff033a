# The README's quick start is demos/hello_cloth.cpp, word for word.
file(READ ${README} readme)
file(READ ${PROGRAM} program)
string(FIND "${readme}" "${program}" place)
if(place EQUAL -1)
  message(FATAL_ERROR "README.md does not contain ${PROGRAM} verbatim: copy it into the quick start")
endif()
