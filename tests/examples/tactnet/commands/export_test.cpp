// tactnet export.

#include "../workshop.hpp"

#include <doctest/doctest.h>

#include <string>
#include <sys/stat.h>
#include <vector>

using namespace support;

TEST_SUITE("program") {
    TEST_CASE("export: a header, the same every time") {
        const workshop shop;
        shop.trains("--epochs 2 --output net");
        const outcome written = shop.succeeds("export --weights net --output out/net.hpp");
        CHECK(written.out.empty());
        const std::string text = text_of(shop / "out/net.hpp");
        CHECK(text.starts_with("// tactnet4 for frames of 7 × 13 × 1 "));
        says(text, "\nnamespace tactile {\ninline namespace TACTNET_ARCH {\n");
        says(text, "\"middle, of all\"");
        says(text, "inline constexpr recogniser_type::packed_weights packed");
        shop.succeeds("export --weights net --output again.hpp");
        CHECK(text_of(shop / "again.hpp") == text);
        REQUIRE(
            shop.run("export --weights net --output other.hpp --namespace gripper::left --packing at-start")
                .status == 0);
        says(text_of(shop / "other.hpp"), "\nnamespace gripper::left {\ninline namespace TACTNET_ARCH {\n");
        says(text_of(shop / "other.hpp"), "inline const recogniser_type::packed_weights packed");

        tactnet::write_file(shop / "names", std::string("one\ntw\x1B[31mo\nthree\n"));
        REQUIRE(::mkfifo((shop / "pipe").c_str(), 0600) == 0);
        shop.refuses_each({
            {"export --weights net", "--output is required"},
            {"export --weights net --output x.hpp --packing never", "--packing: never not in {"},
            {"export --weights net --output x.hpp --namespace a-b",
             "--namespace: expected a name such as gripper or gripper::tactile, found 'a-b'"},
            {{"export", "--weights", "net", "--output", "x.hpp", "--classes", ""},
             "--classes: expected a file or a folder of names, found ''"},
            {"export --weights net --output x.hpp --classes names",
             "names: name 2: expected a name without control characters, found 'tw\\x1b[31mo'"},
            {"export --weights net --output pipe", "expected a regular file, found a named pipe"},
            {"export --weights nothing --output x.hpp",
             "nothing: expected a file, found nothing of that name"},
            {"export --weights net --output out", "found a folder"},
        });
        tactnet::write_file(shop / "cut", std::string_view(text).substr(0, 100));
        shop.refuses("export --weights cut --output out/net.hpp", "cut: ");
        CHECK(text_of(shop / "out/net.hpp") == text);
    }
}
