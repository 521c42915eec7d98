// expect: static assertion failed|static_assert failed
// expect: an image of 3 rows is too small
// at-most: 1
#include <tactnet/version.hpp>

template <int Rows>
struct image {
    static_assert(Rows >= 7, "an image of 3 rows is too small");
};

int main() {
    return static_cast<int>(sizeof(image<3>));
}
