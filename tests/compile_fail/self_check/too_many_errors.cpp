// expect: the first is wrong
// at-most: 1
int main() {
    static_assert(false, "the first is wrong");
    static_assert(false, "the second is wrong");
}
