# Sources of Spikeloop that the library contains. tests/ros_package links them without rclcpp, so that
# a missing one is found where ROS 2 is not installed.
set(spikeloop_sources core/src/code.cpp core/src/error.cpp robots/topics/src/names.cpp)
set(spikeloop_modules core robots/messages robots/topics robots/session)
