#include <tactnet/svm.hpp>

#include <vector>

#ifdef CASE_rows_of_temporary
// expect: values of a temporary: give it a name
// at-most: 1
void run() {
    static_cast<void>(tactnet::feature_rows<8>(std::vector<float>(16)));
}
#endif
