#include <tactnet/version.hpp>

template <int Rows>
struct image {
    static_assert(Rows >= 7, "an image of 3 rows is too small");
};

#ifdef CASE_refused
// expect: static assertion failed|static_assert failed
// expect: an image of 3 rows is too small
// at-most: 1
int main() {
    return static_cast<int>(sizeof(image<3>));
}
#endif

// Another case of the file has no part in this one.
#ifdef CASE_beside
// expect: static assertion failed|static_assert failed
// expect: nothing of images
// at-most: 1
static_assert(false, "nothing of images");
#endif
