#pragma once

// Methods behind a network that stays as it is: its features are found once.

#include "../workshop.hpp"
#include "pretrained_weights.hpp"

#include <tactnet/io/safetensors/source.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <string>
#include <vector>

namespace support {

/// Fewer images than the workshop has: networks are large.
inline void keep_images(const workshop& shop, std::size_t count) {
    for (const char* folder : {"left", "middle, of all", "right"})
        for (std::size_t i = count; i < images_per_class; ++i)
            fs::remove(shop.data() / folder / ("image" + std::to_string(i) + ".png"));
}
inline std::vector<std::string> training(const workshop& shop, const std::string& method,
                                         const std::string& output, words more = {}) {
    more.insert(more.begin(), {"--method", method, "--output", output, "--pretrained", "pretrained"});
    return shop.train_arguments(more);
}
inline bool knows(const workshop& shop, const std::string& method) {
    const bool found = shop.run("list").out.find(method + " ") != std::string::npos;
    if (!found)
        MESSAGE("skipped: the program was built without " << method);
    return found;
}
/// Trained, saved, tested and used, from a file by torchvision's names to a file that needs it no more.
/// `selftest` is the array of what its own images gave.
template <class Network>
void check_from_end_to_end(const std::string& method, tactnet::element_type type,
                           const std::string& selftest) {
    const workshop shop;
    if (!knows(shop, method))
        return;
    CAPTURE(method);
    keep_images(shop, 3);
    write_pretrained<Network>(shop / "pretrained", type);
    const outcome trained = shop.succeeds(
        training(shop, method, "net", {"--validation", "0", "--test", "0.3", "--self-test", "1"}));
    says(trained.error, "features of 9 of 9 images");
    CHECK_FALSE(fs::exists(shop / "net.features"));
    {
        const auto file = tactnet::safetensors_source::open(shop / "net");
        CHECK(file.metadata().at("network") == method);
        CHECK(file.metadata().count("pretrained") == 1);
        for (const tactnet::parameter& p : Network::describe()) {
            const auto& array = file.at("trunk." + p.name);
            CHECK(array.extents == p.extents);
            CHECK(array.type == type);
        }
        CHECK_FALSE(file.contains("trunk.classifier.6.bias"));
        CHECK(file.contains(selftest));
    }
    fs::remove(shop / "pretrained");
    const outcome found =
        shop.succeeds({"classify", "--weights", "net", (shop.data() / "left" / "image0.png").string(),
                       (shop.data() / "right" / "image1.png").string()});
    CHECK(lines_of(found.out).size() == 2);
    const outcome tested = shop.succeeds("evaluate --weights net --data DATA --results r");
    CHECK(text_of(shop / "r/confusion_net.csv") == text_of(shop / "net.confusion.csv"));
}

} // namespace support
