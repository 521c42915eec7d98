#include <tactnet/sensors.hpp>

#ifdef CASE_frame_of_temporary
// expect: the frame would dangle
// at-most: 1
void run() {
    static_cast<void>(tactnet::read_recording("hand.csv")[5]);
}
#endif

#ifdef CASE_frame_of_temporary_with_shape
// expect: the frame would dangle
// at-most: 1
void run() {
    static_cast<void>(tactnet::read_recording("hand.csv").as<tactnet::shape{28, 50, 1}>(5));
}
#endif

#ifdef CASE_places_of_temporary
// expect: would dangle
// at-most: 1
void run() {
    static_cast<void>(tactnet::tekscan_map().places());
}
#endif

#ifdef CASE_warnings_of_temporary
// expect: would dangle
// at-most: 1
void run() {
    static_cast<void>(tactnet::decoding_warnings().kept());
}
#endif
