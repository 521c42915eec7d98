int main() {
    static_assert(false, "a case that does not say what it expects");
}
