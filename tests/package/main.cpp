// What a user of the library writes first.

#include <tactnet/networks.hpp>

static_assert(tactnet::tactnet6<tactnet::shape{28, 50, 1}, 22>::multiply_adds == 2'214'080);

int main() {}
