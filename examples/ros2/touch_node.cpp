// A ROS 2 node that names what a tactile array touches. It is not compiled here, since the tests have no ROS;
// they test its core, touch_core.hpp.
//
//     ros2 run my_package touch_node --ros-args -p weights:=net.safetensors -r pressure:=/gripper
#include "touch_core.hpp"

#include <tactnet/io.hpp>

#include <cstdio>
#include <exception>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/image.hpp>
#include <std_msgs/msg/string.hpp>
#include <string>

using net = tactnet::tactnet4<tactnet::shape{14, 25}, 22>; // the network of the weight file

class touch_node : public rclcpp::Node {
public:
    touch_node()
        : Node("touch"),
          core_(tactnet::load_deployed<net>(declare_parameter<std::string>("weights"))),
          labels_(create_publisher<std_msgs::msg::String>("label", 10)),
          images_(create_subscription<sensor_msgs::msg::Image>(
              "pressure", rclcpp::SensorDataQoS(),
              [this](const sensor_msgs::msg::Image& image) { read(image); })) {}

private:
    void read(const sensor_msgs::msg::Image& image) {
        constexpr tactnet::shape array = touch_core<net>::array;
        if (image.encoding != "mono8" || image.height != array.rows || image.width != array.columns) {
            RCLCPP_ERROR_ONCE(get_logger(), "expected mono8 of %zu x %zu, found %s of %u x %u", array.rows,
                              array.columns, image.encoding.c_str(), image.height, image.width);
            return;
        }
        const auto report = core_.read(image.height, image.width, image.step, image.data);
        if (!report || report->label.empty())
            return;
        std_msgs::msg::String label;
        label.data = std::string(report->label) + " " + std::to_string(report->probability);
        labels_->publish(label);
    }

    touch_core<net> core_;
    rclcpp::Publisher<std_msgs::msg::String>::SharedPtr labels_;
    rclcpp::Subscription<sensor_msgs::msg::Image>::SharedPtr images_;
};

int main(int argc, char** argv) {
    rclcpp::init(argc, argv);
    int status = 0;
    try {
        rclcpp::spin(std::make_shared<touch_node>());
    } catch (const std::exception& error) { // such as a weight file that does not fit
        std::fprintf(stderr, "touch_node: %s\n", error.what());
        status = 1;
    }
    rclcpp::shutdown();
    return status;
}
