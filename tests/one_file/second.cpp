// See first.cpp.
#include <one_file.hpp>

// A second time, it is guarded.
#include <one_file.hpp>
