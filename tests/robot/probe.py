#!/usr/bin/python3
"""Listens to the robot and drives it, as ROS users do: rospy and the stock message classes.

usage: probe.py SIMULATED_SECONDS LINEAR ANGULAR

Publishes LINEAR and ANGULAR on /cmd_vel all the time, listens until the robot's clock has advanced
by SIMULATED_SECONDS, and prints what came as one JSON object.
"""

import json
import math
import sys
import threading

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan


def finite(value):
    return value if math.isfinite(value) else str(value)


class Probe:
    def __init__(self, seconds):
        self.seconds = seconds
        self.clock, self.scans, self.odometry = [], [], []
        self.done = threading.Event()
        self.subscribers = [
            rospy.Subscriber("/scan", LaserScan, self.scans.append, queue_size=1000),
            rospy.Subscriber("/odom", Odometry, self.odometry.append, queue_size=1000),
            rospy.Subscriber("/clock", Clock, self.take_clock, queue_size=1000),
        ]

    def take_clock(self, message):
        self.clock.append(message.clock)
        if (message.clock - self.clock[0]).to_sec() >= self.seconds and self.scans and self.odometry:
            self.done.set()

    def report(self):
        scan = self.scans[-1]
        return {
            "clock_ns": [stamp.to_nsec() for stamp in self.clock],
            "scan_ns": [message.header.stamp.to_nsec() for message in self.scans],
            "scan_sequence": [message.header.seq for message in self.scans],
            "scan_frame": scan.header.frame_id,
            "angle_min": scan.angle_min,
            "angle_max": scan.angle_max,
            "angle_increment": scan.angle_increment,
            "range_min": scan.range_min,
            "range_max": scan.range_max,
            "scan_time": scan.scan_time,
            "ranges": [finite(value) for value in scan.ranges],
            "odometry_ns": [message.header.stamp.to_nsec() for message in self.odometry],
            "odometry_frames": [self.odometry[-1].header.frame_id,
                                self.odometry[-1].child_frame_id],
            "x": [message.pose.pose.position.x for message in self.odometry],
            "y": [message.pose.pose.position.y for message in self.odometry],
            "theta": [2 * math.atan2(message.pose.pose.orientation.z,
                                     message.pose.pose.orientation.w)
                      for message in self.odometry],
            "speed": [message.twist.twist.linear.x for message in self.odometry],
            "yaw_rate": [message.twist.twist.angular.z for message in self.odometry],
        }


def main():
    seconds, linear, angular = (float(argument) for argument in sys.argv[1:])
    rospy.init_node("probe", anonymous=True, disable_rosout=True, disable_signals=True)
    probe = Probe(seconds)
    publisher = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
    twist = Twist()
    twist.linear.x, twist.angular.z = linear, angular
    while not probe.done.wait(0.02):
        publisher.publish(twist)
    print(json.dumps(probe.report()))


main()
