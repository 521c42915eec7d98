// A case for each way not to be a case: the check must refuse it, and say why.

#ifdef CASE_compiles
// expect: anything
#include <tactnet/version.hpp>

int main() {
    return TACTNET_VERSION_MAJOR;
}

#elif defined(CASE_other_message)
// expect: an image of 3 rows is too small
int main() {
    static_assert(false, "something else is wrong");
}

#elif defined(CASE_too_many_errors)
// expect: the first is wrong
// at-most: 1
int main() {
    static_assert(false, "the first is wrong");
    static_assert(false, "the second is wrong");
}

#elif defined(CASE_too_many_characters)
// expect: static.assert.*the sentence
// at-most: 1
// characters: 20
static_assert(false, "the sentence");

#elif defined(CASE_no_expectation)
int main() {
    static_assert(false, "a case that does not say what it expects");
}
#endif
