#pragma once

// What the paper found on the same images: its table of methods and the numbers behind its figure of
// resolutions (J. M. Gandarias, A. J. García-Cerezo, J. M. Gómez-de-Gabriel, "CNN-based Methods for Object
// Recognition with High-Resolution Tactile Sensors", IEEE Sensors Journal 2019; the latter by the authors'
// published programs).

#include <array>
#include <cstddef>
#include <string_view>

struct published_result {
    std::string_view title, method; ///< the paper's name, and that of the same method here
    std::size_t rows, columns;
    double accuracy, deviation; ///< of 20 random splits, in percent
    double seconds;             ///< an image on the paper's processor; 0 where it has none
};

inline constexpr std::array published_results{
    published_result{"SURF-SVM", "surf-svm", 28, 50, 77.64, 3.62, 0.029},
    published_result{"SqueezeNet-SVM", "squeezenet-svm", 28, 50, 85.82, 2.57, 7.934},
    published_result{"AlexNet-SVM", "alexnet-svm", 28, 50, 87.73, 4.22, 4.141},
    published_result{"ResNet-SVM", "resnet50-svm", 28, 50, 92.77, 2.52, 23.848},
    published_result{"VGG16-SVM", "vgg16-svm", 28, 50, 93.50, 1.83, 73.355},
    published_result{"SqueezeNet-NN", "squeezenet-nn", 28, 50, 94.23, 2.10, 8.515},
    published_result{"AlexNet-NN", "alexnet-nn", 28, 50, 94.14, 1.71, 4.982},
    published_result{"ResNet-NN", "resnet50-nn", 28, 50, 95.36, 1.24, 27.039},
    published_result{"VGG16-NN", "vgg16-nn", 28, 50, 94.14, 2.35, 64.488},
    published_result{"TactNet-4", "tactnet4", 28, 50, 93.59, 1.66, 0.094},
    published_result{"TactNet-6", "tactnet6", 28, 50, 95.02, 1.33, 0.103},
    published_result{"TactResNet", "tactresnet", 28, 50, 93.61, 1.62, 0.465},
    published_result{"TactNet-6", "tactnet6", 20, 35, 93.41, 1.55, 0},
    published_result{"TactNet-6", "tactnet6", 14, 25, 93.33, 1.93, 0},
    published_result{"TactNet-6", "tactnet6", 10, 18, 87.48, 2.33, 0},
    published_result{"TactNet-6", "tactnet6", 7, 13, 84.84, 2.65, 0},
    published_result{"ResNet-NN", "resnet50-nn", 20, 35, 95.34, 1.12, 0},
    published_result{"ResNet-NN", "resnet50-nn", 14, 25, 95.28, 1.21, 0},
    published_result{"ResNet-NN", "resnet50-nn", 10, 18, 94.18, 1.43, 0},
    published_result{"ResNet-NN", "resnet50-nn", 7, 13, 87.41, 1.35, 0},
    published_result{"VGG16-SVM", "vgg16-svm", 20, 35, 92.52, 1.46, 0},
    published_result{"VGG16-SVM", "vgg16-svm", 14, 25, 86.11, 7.51, 0},
    published_result{"VGG16-SVM", "vgg16-svm", 10, 18, 83.41, 3.09, 0},
    published_result{"VGG16-SVM", "vgg16-svm", 7, 13, 66.32, 6.13, 0},
};

/// Null for what the paper does not have.
constexpr const published_result* find_published(std::string_view method, std::size_t rows,
                                                 std::size_t columns) {
    for (const published_result& p : published_results)
        if (p.method == method && p.rows == rows && p.columns == columns)
            return &p;
    return nullptr;
}
