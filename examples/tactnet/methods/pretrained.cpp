#include "methods/pretrained.hpp"

#include "data/fingerprint.hpp"
#include "methods/method.hpp"
#include "methods/training_settings.hpp"
#include "usage_error.hpp"

#include <fmt/format.h>

#include <map>
#include <mutex>

void check_pretrained(const method& what, const training_settings& settings) {
    const auto file = what.pretrained();
    if (!file && !settings.pretrained.empty())
        throw usage_error(fmt::format("--pretrained: expected a method that begins with a network trained on "
                                      "photographs, found {}, which learns all by itself",
                                      what.name));
    if (file && settings.pretrained.empty())
        throw usage_error(fmt::format(
            "--pretrained: {0} expects a file of {1}'s weights, found none. It is a safetensors file with "
            "torchvision's names ({2}, ...) in float32, float16 or bfloat16, at least {3:.1f} MB in float32, "
            "trained "
            "on photographs of {4} x {5} with torchvision's normalisation, or with an array 'input_mean' of "
            "three numbers that are subtracted from counts of 0 to 255. Python makes it where torchvision "
            "and safetensors are: import torchvision; from safetensors.torch import save_file; "
            "save_file(torchvision.models.{6}(weights=\"IMAGENET1K_V1\").state_dict(), "
            "\"{6}.safetensors\"); see docs/transfer.md",
            what.name, file->network.title, file->array, static_cast<double>(file->bytes) * 1e-6,
            file->network.photograph.rows, file->network.photograph.columns, file->network.torchvision));
}

std::shared_ptr<pretrained_weights> open_pretrained(const method& what, const training_settings& settings) {
    check_pretrained(what, settings);
    return what.pretrained() ? what.open_pretrained(settings.pretrained) : nullptr;
}

std::string pretrained_fingerprint(const std::string& path) {
    static std::mutex mutex;
    static std::map<std::string, std::string> known;
    const std::lock_guard lock(mutex);
    std::string& print = known[path];
    if (print.empty())
        print = file_fingerprint(path);
    return print;
}
