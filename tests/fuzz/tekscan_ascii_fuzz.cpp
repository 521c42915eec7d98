// Any bytes as a Tekscan text recording.

#include "decoder_fuzz.hpp"
#include "fuzz_target.hpp"

#include <tactnet/sensors/tekscan/ascii.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::check(tactnet::tekscan_ascii(), fuzz::bytes_of(data, size));
    return 0;
}

std::vector<std::vector<std::uint8_t>> fuzz_seeds() {
    return {
        fuzz::input(
            "DATA_TYPE MOVIE\r\nVERSION 6.10I\r\nROWS 2\r\nCOLS 3\r\nROW_SPACING 0.127 centimeters\r\n"
            "SENSEL_AREA 0.016129 cm2\r\nNOISE_THRESHOLD 3\r\nSECONDS_PER_FRAME 0.1\r\nSTART_FRAME 1\r\n"
            "END_FRAME 2\r\nUNITS raw\r\nASCII_DATA @@\r\n\r\nFrame 1, 0,, 1/2/2019 6:21PM,,,Raw Sum=,,8\r\n"
            "B,5,0\r\n1,2,0\r\n\r\nFrame 2, 0.1,, 1/2/2019 6:21PM,,,Raw Sum=,,3\r\nB,0,0\r\n1,2,0\r\n@@\r\n"),
        fuzz::input(
            "\xEF\xBB\xBFROWS 2,,\nCOLS 2,,\nROW_SPACING 5 mm,,\nSATURATION_PRESSURE 1514.73 KPa ,,\n"
            "COMMENTS:,,\nfree, text,,\nCALIBRATION_POINT_1 75.0001 (Kgs) 4798 (Raw Sum)\nUNITS KPa,,\n"
            "ASCII_DATA @@,,\n,,,\n\"Frame 7, 20 ms\"\n1.5\t2e2\n,,,\n0 0.25\nFrame 8\n1;2\n3;4,,\n"),
        fuzz::input("ROWS 1\nCOLS 4\nUNITS PSI\nCOMMENT @@\nlong\n@@\nASCII_DATA @@\n12.25, 3 "
                    ",B,999999999\n@@\n\x1A"),
        fuzz::input(
            "ROWS 1\nCOLS 1\nCOMMENTS:\nASCII_DATA by hand\nUNITS were wrong\nROWS 2\nUNITS kg/cm\xB2\n"
            "ASCII_DATA @@\nFrame 1, -100 ms\n1\nFrame 2 , -90 ms, 6:21\n2\n@@\n"),
        fuzz::input("ROWS 1\nCOLS 1\nSECONDS_PER_FRAME 0.01\nASCII_DATA @@\nFrame 1,0\n1\nFrame 2,10,ms\n1\n"
                    "Frame 9 , 80.0\n255\n"),
    };
}
