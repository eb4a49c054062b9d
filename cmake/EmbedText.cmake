# cmake -DINPUT=FILE -DOUTPUT=FILE -P EmbedText.cmake: a text file as a C++ raw string literal, to be included.
file(READ ${INPUT} text)
file(WRITE ${OUTPUT} "R\"lodeline_text(${text})lodeline_text\"\n")
