// Two units of one program with the one-file form: nothing is defined twice.
#include <one_file.hpp>
