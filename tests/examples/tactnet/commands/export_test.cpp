// tactnet export.

#include "../workshop.hpp"

#include <doctest/doctest.h>

#include <string>
#include <vector>

using namespace support;

TEST_SUITE("program") {
    TEST_CASE("export: a header, the same every time") {
        const workshop shop;
        REQUIRE(shop.train({"--epochs", "2", "--output", "net"}).status == 0);
        const outcome written = shop.run({"export", "--weights", "net", "--output", "out/net.hpp"});
        REQUIRE_MESSAGE(written.status == 0, written.error);
        CHECK(written.out.empty());
        const std::string text = text_of(shop / "out/net.hpp");
        CHECK(text.starts_with("// tactnet4 for frames of 7 × 13 × 1 "));
        CHECK(text.find("\nnamespace tactile {\ninline namespace TACTNET_ARCH {\n") != std::string::npos);
        CHECK(text.find("\"middle, of all\"") != std::string::npos);
        CHECK(text.find("inline constexpr recogniser_type::packed_weights packed") != std::string::npos);
        REQUIRE(shop.run({"export", "--weights", "net", "--output", "again.hpp"}).status == 0);
        CHECK(text_of(shop / "again.hpp") == text);
        REQUIRE(shop.run({"export", "--weights", "net", "--output", "other.hpp", "--namespace",
                          "gripper::left", "--packing", "at-start"})
                    .status == 0);
        CHECK(text_of(shop / "other.hpp")
                  .find("\nnamespace gripper::left {\ninline namespace TACTNET_ARCH {\n") !=
              std::string::npos);
        CHECK(text_of(shop / "other.hpp").find("inline const recogniser_type::packed_weights packed") !=
              std::string::npos);

        shop.refuses({"export", "--weights", "net"}, "--output is required");
        shop.refuses({"export", "--weights", "net", "--output", "x.hpp", "--packing", "never"}, "--packing");
        shop.refuses({"export", "--weights", "net", "--output", "x.hpp", "--namespace", "a-b"},
                     "--namespace: expected a name such as gripper or gripper::tactile, found 'a-b'");
        shop.refuses({"export", "--weights", "nothing", "--output", "x.hpp"},
                     "nothing: expected a file, found nothing of that name");
        shop.refuses({"export", "--weights", "net", "--output", "out"}, "found a folder");
        tactnet::write_file(shop / "cut", std::string_view(text).substr(0, 100));
        shop.refuses({"export", "--weights", "cut", "--output", "out/net.hpp"}, "cut: ");
        CHECK(text_of(shop / "out/net.hpp") == text);
    }
}
