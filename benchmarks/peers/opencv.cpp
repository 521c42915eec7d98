#include "image_peer.hpp"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace benchmark {
namespace {

cv::Mat over(const float* pixels, image_size size) {
    return {static_cast<int>(size.rows), static_cast<int>(size.columns), CV_32F, const_cast<float*>(pixels)};
}

} // namespace

const char* opencv_version() {
    return CV_VERSION;
}
void opencv_on_one_thread() {
    cv::setNumThreads(1);
}
void opencv_resize(const float* from, image_size from_size, float* to, image_size to_size) {
    cv::Mat result = over(to, to_size);
    cv::resize(over(from, from_size), result, result.size(), 0, 0, cv::INTER_CUBIC);
}
void opencv_affine(const float* from, float* to, image_size size, const double (&map)[6]) {
    cv::Mat result = over(to, size);
    cv::warpAffine(over(from, size), result, cv::Matx23d(map), result.size(),
                   cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_CONSTANT);
}

} // namespace benchmark
