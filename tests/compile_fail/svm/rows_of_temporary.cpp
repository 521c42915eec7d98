// expect: values of a temporary: give it a name
// at-most: 1
#include <tactnet/svm.hpp>

#include <vector>

void run() {
    static_cast<void>(tactnet::feature_rows<8>(std::vector<float>(16)));
}
