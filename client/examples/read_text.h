/* A file as a text of its own, to be freed; NULL if it cannot be read. */
#include <stdio.h>
#include <stdlib.h>

static char* read_text(const char* name) {
  FILE* file = fopen(name, "rb");
  char* text = NULL;
  long length = 0;
  if (file == NULL)
    return NULL;
  if (fseek(file, 0, SEEK_END) == 0 && (length = ftell(file)) >= 0 && fseek(file, 0, SEEK_SET) == 0)
    text = calloc((size_t)length + 1, 1);
  if (text != NULL && fread(text, 1, (size_t)length, file) != (size_t)length) {
    free(text);
    text = NULL;
  }
  fclose(file);
  return text;
}
