// The program `tactnet_decode` from outside.

#include <tactnet/io/write_file.hpp>

#include <doctest/doctest.h>

#include <string>
#include <support/files/data_folder.hpp>
#include <support/files/temporary_folder.hpp>
#include <support/run_program.hpp>

using support::run_program;

namespace {

const std::string program = TACTNET_DECODE_PROGRAM;
const std::string recording =
    "VERSION 6.10I\r\nROWS 2\r\nCOLS 3\r\nSECONDS_PER_FRAME 0.1\r\nSTART_FRAME 1\r\n"
    "END_FRAME 3\r\nUNITS KPa\r\nASCII_DATA @@\r\nFrame 1\r\nB,0.5,0\r\n1,2,3\r\n"
    "Frame 2\r\nB,5,0\r\n1,2,3\r\nFrame 4\r\nB,5,0\r\n1,2,255\r\n@@\r\n";

class recording_file {
public:
    explicit recording_file(const std::string& text) { tactnet::write_file(path(), text); }
    std::filesystem::path path() const { return folder_ / "a recording"; }
    std::string quoted() const { return " '" + path().string() + "'"; }
    std::filesystem::path operator/(const char* name) const { return folder_ / name; }

private:
    support::temporary_folder folder_;
};

/// Exit status 2, nothing but the sentence.
void refuses(const std::string& command, const std::string& sentence) {
    CAPTURE(command);
    const auto result = run_program(command);
    CHECK(result.status == 2);
    CHECK_MESSAGE(result.error.find(sentence) != std::string::npos, result.error);
}

} // namespace

TEST_SUITE("decode") {
    TEST_CASE("decode: the summary") {
        const recording_file file(recording);
        const auto result = run_program(program + file.quoted());
        CHECK(result.status == 0);
        CHECK(result.error.empty());
        CHECK(result.out == "format: Tekscan ASCII\nversion: 6.10I\nrows: 2\ncolumns: 3\nframes: 3\n"
                            "missing cells: 1\nunit: pascal\nseconds: 0.3\n");
    }

    TEST_CASE("decode: an output file at its limit is an error with its reason") {
        std::string frames = recording.substr(0, recording.find("Frame 1"));
        frames.replace(frames.find("END_FRAME 3"), 11, "END_FRAME 400");
        for (int number = 1; number <= 400; ++number)
            frames += "Frame " + std::to_string(number) + "\r\nB,0.5,0\r\n1,2,3\r\n";
        const recording_file file(frames + "@@\r\n");
        const std::string output = " >'" + (file / "output").string() + "'";
        CHECK(run_program(program + " --csv" + file.quoted() + output).status == 0);
        refuses("ulimit -f 2; " + program + " --csv" + file.quoted() + output,
                "standard output: expected to write all results, found 'File too large'");
    }

    TEST_CASE("decode: every frame as text") {
        const recording_file file(recording);
        const auto result = run_program(program + " --csv" + file.quoted());
        CHECK(result.status == 0);
        CHECK(result.out == "frame,1,0\nB,500,0\n1000,2000,3000\nframe,2,0.1\nB,5000,0\n1000,2000,3000\n"
                            "frame,4,0.3\nB,5000,0\n1000,2000,255000\n");
    }

    TEST_CASE("decode: of a damaged recording the whole frames, and what is wrong") {
        const recording_file file(recording.substr(0, recording.find("Frame 4") + 19));
        for (const std::string option : {"", " --csv"}) {
            const auto result = run_program(program + option + file.quoted());
            CHECK(result.status == 2);
            CHECK(result.out.find(option.empty() ? "frames: 2\n" : "frame,2,0.1\n") != std::string::npos);
            CHECK(result.error.find(
                      "frame 3: expected more cells in this row in column 3 of 3, found the end of the "
                      "data (1 announced frames are missing)") != std::string::npos);
        }
    }

    TEST_CASE("decode: warnings, and how many frames are certain, on standard error") {
        using namespace std::string_literals;
        const std::string header =
                              "ROWS 1\nCOLS 3\nNOISE_THRESHOLD 3\nSECONDS_PER_FRAME 1\nFRAMES 3\n\xBB\xBA",
                          frame = "\x01\x00\x02\x07\x08\xFF\xFF\xFF\xFF"s,
                          quiet = "\x01\x00\x02\x07\x02\xFF\xFF\xFF\xFF"s;
        const recording_file odd(header + frame + frame + quiet + "\xFF\xFE"),
            cut(header + frame + frame + "\x01");
        const auto warned = run_program(program + odd.quoted());
        CHECK(warned.status == 0);
        CHECK(warned.out.find("frames: 3\n") != std::string::npos);
        CHECK(warned.error == "tactnet_decode: " + odd.path().string() + ": byte " +
                                  std::to_string(header.size() + 2 * frame.size() + 4) +
                                  ", frame 3: warning: expected counts of at least 3 (NOISE_THRESHOLD), "
                                  "found 2 in cell 2\n");
        refuses(program + cut.quoted(), ": the first 1 of 2 frames are certain\n");
        // More than are kept are counted.
        const std::string wide =
            "ROWS 1\nCOLS 30\nNOISE_THRESHOLD 3\nSECONDS_PER_FRAME 1\nFRAMES 1\n\xBB\xBA";
        const recording_file noisy(wide + "\x00\x00\x14"s + std::string(20, '\x01') +
                                   "\xFF\xFF\xFF\xFF\xFF\xFE");
        const auto counted = run_program(program + noisy.quoted());
        CHECK(counted.status == 0);
        CHECK(counted.error.find(": 4 more warnings\n") != std::string::npos);
    }

    TEST_CASE("decode: any array by its description") {
        using namespace std::string_literals;
        const recording_file lines("300,7,299\n299,298,65535\n"), other("5;6\n");
        const std::string json = (lines / "mat.json").string();
        tactnet::write_file(json, std::string(R"({"rows": 1, "columns": 3, "cell": "digits", "offset": 300,)"
                                              R"( "inverted": true, "broken": [65535]})"));
        const auto result = run_program(program + " --csv --sensor " + json + lines.quoted());
        CHECK(result.status == 0);
        CHECK(result.out == "frame,1,\n0,293,1\nframe,2,\n1,2,nan\n");
        refuses(program + " --sensor " + json + other.quoted(),
                "line 1, frame 1: expected 3 numbers, found 2");
        refuses(program + " --sensor " + json + " --map " + json + lines.quoted(), "found both");
    }

    TEST_CASE("decode: pictures") {
        const recording_file file(recording);
        const auto picture = (file / "out.png").string();
        const auto result = run_program(program + " --picture 4 " + picture + file.quoted());
        if (result.error.find("built without PNG") != std::string::npos)
            return;
        CHECK(result.status == 0);
        CHECK(support::text_of(picture).substr(1, 3) == "PNG");
        refuses(program + " --picture 3 " + picture + ".none" + file.quoted(),
                "expected a frame with number 3, found 3 frames with others");
        CHECK(!std::filesystem::exists(picture + ".none"));
        refuses(program + " --picture 1 /no/such/folder/x.png" + file.quoted(),
                "expected a folder to write in");
    }

    TEST_CASE("decode: what cannot be read, written or understood") {
        const recording_file file(recording), empty(""), other("not a recording\n");
        refuses(program + " /no/such/file", "/no/such/file: expected a file, found nothing of that name");
        // A name that would clear the terminal.
        refuses(program + " '/no/\x1b[2J'", "/no/\\x1b[2J: expected a file, found nothing of that name");
        refuses(program + " /", "/: expected a file, found a folder");
        refuses(program + empty.quoted(), "expected a Tekscan recording or map");
        refuses(program + other.quoted(), "expected a Tekscan recording or map");
        refuses(program, "expected a file");
        refuses(program + " --colour" + file.quoted(), "unknown option '--colour'");
        refuses(program + file.quoted() + file.quoted(), "expected one file");
        refuses(program + " --picture x y" + file.quoted(),
                "expected the number of a frame behind --picture, found 'x'");
        refuses(program + " --picture 1", "expected a file to draw to");
        refuses(program + " --csv --picture 1 x" + file.quoted(), "expected --csv or --picture, found both");
        if (std::filesystem::exists("/dev/full"))
            refuses(program + file.quoted() + " >/dev/full",
                    "standard output: expected to write all results");
        // A reader that has gone: no signal ends the program.
        std::string many = recording.substr(0, recording.find("START"));
        many += "UNITS raw\nASCII_DATA @@\n";
        for (int i = 1; i < 20'000; ++i)
            many += "Frame " + std::to_string(i) + "\nB,1,2\n3,4,5\n";
        const recording_file large(many);
        CHECK(run_program("( " + program + " --csv" + large.quoted() + "; echo $? >&2 ) | true")
                  .error.find("\n2\n") != std::string::npos);
        CHECK(run_program(program + " --help").status == 0);
    }

    TEST_CASE("decode: a map says which cells have a tactel") {
        using namespace std::string_literals;
        const std::string size = "ROWS 1\nCOLS 3\n";
        const recording_file binary(size + "\xBB\xBA\x01\x00\x02\x07\x08\xFF\xFF\xFF\xFF\xFF\xFE"s),
            text(size + "ASCII_DATA @@\nB,7,8\n@@\n"), map(size + "SENSOR_MAP @@\nB,0,1\n@@\n"),
            wrong(size + "SENSOR_MAP @@\n0,B,1\n@@\n");
        CHECK(run_program(program + " --csv" + binary.quoted()).out == "frame,1,\n0,7,8\n");
        for (const recording_file* file : {&binary, &text}) {
            const std::string command = program + " --csv" + file->quoted() + " --map";
            CHECK(run_program(command + map.quoted()).status == 0);
            CHECK(run_program(command + map.quoted()).out == "frame,1,\nB,7,8\n");
            CHECK(run_program(command + wrong.quoted()).status == 2);
            refuses(command + binary.quoted(), "expected a map of a sensor, found a recording without one");
        }
        refuses(program + " --map" + wrong.quoted() + binary.quoted(),
                "expected counts on tactels of the map only, found one in cell 1");
        refuses(program + " --map" + wrong.quoted() + text.quoted(),
                "expected tactels in the cells of the map, found others");
        refuses(program + " --map /no/such/map" + text.quoted(), "/no/such/map: expected a file");
    }

    TEST_CASE("decode: the real recording with the map of its sensor" * doctest::test_suite("data")) {
        const auto recorded = support::find_data("tekscan/MySampleRecording.fsx");
        const auto map = support::find_data("tekscan/null.mp");
        if (!recorded || !map)
            return;
        const auto result = run_program(program + " --map " + map->string() + " " + recorded->string());
        CHECK(result.status == 0);
        CHECK(result.out.find("frames: 500\n") != std::string::npos);
        CHECK(run_program(program + " " + map->string()).out.find("format: Tekscan map\n") !=
              std::string::npos);
    }
}
