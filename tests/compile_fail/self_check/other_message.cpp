// expect: an image of 3 rows is too small
int main() {
    static_assert(false, "something else is wrong");
}
