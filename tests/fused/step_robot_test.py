#!/usr/bin/python3
"""spikeloop-robot --step, driven by hand: it is where it is told to be, and begins again as before."""

import json
import pathlib
import queue
import sys
import tempfile
import time

import ros
import runs

TICK_NS = 10_000_000


class Experiment:
    """The experiment's side, in rospy."""

    def __init__(self):
        import rospy
        from geometry_msgs.msg import Twist
        from nav_msgs.msg import Odometry
        from sensor_msgs.msg import LaserScan
        from std_msgs.msg import String
        rospy.init_node("experiment", anonymous=True, disable_rosout=True, disable_signals=True)
        self.twist = Twist
        self.answers = queue.Queue()
        self.scans, self.odometry, self.sent = [], [], 0
        self.steps = rospy.Publisher("/spikeloop/step", String, queue_size=10, tcp_nodelay=True)
        self.wheels = rospy.Publisher("/cmd_vel", Twist, queue_size=10, tcp_nodelay=True)
        self.subscribers = [
            rospy.Subscriber("/spikeloop/stepped", String,
                             lambda message: self.answers.put(json.loads(message.data))),
            rospy.Subscriber("/scan", LaserScan, lambda scan: self.scans.append(scan.ranges)),
            rospy.Subscriber("/odom", Odometry, lambda odometry: self.odometry.append(
                (odometry.header.stamp.to_nsec(), odometry.pose.pose.position.x,
                 odometry.pose.pose.position.y, odometry.twist.twist.linear.x)))]
        topics = (self.steps, self.wheels, *self.subscribers)
        ros.until(lambda: all(topic.get_num_connections() for topic in topics), "a connection")

    def ask(self, text):
        self.steps.publish(text)
        return self.answers.get(timeout=60)

    def begin(self, **more):
        self.sent = 0
        self.scans.clear()
        self.odometry.clear()
        return self.ask(json.dumps({"begin": True, **more, "tick_ns": TICK_NS, "sensors": ["/scan", "/odom"],
                                    "commands": ["/cmd_vel"]}))

    def command(self, speed):
        twist = self.twist()
        twist.linear.x = speed
        self.wheels.publish(twist)
        self.sent += 1

    def step(self, to_ns):
        return self.ask(json.dumps({"to_ns": to_ns, "sent": {"/cmd_vel": self.sent}}))

    def drive(self, ticks):
        """Ahead, a command a tick; what the robot published."""
        assert self.begin() == {"time_ns": 0, "published": {"/scan": 1, "/odom": 1}}
        for tick in range(1, ticks + 1):
            self.command(0.4)
            answer = self.step(tick * TICK_NS)
            # A scan every 50 ms and odometry every 20 ms, from 0 on.
            assert answer == {"time_ns": tick * TICK_NS,
                              "published": {"/scan": 1 + tick // 5, "/odom": 1 + tick // 2}}, answer
        ros.until(lambda: len(self.odometry) == 1 + ticks // 2 and
                  len(self.scans) == 1 + ticks // 5, "all messages")
        return list(self.odometry), list(self.scans)


def main():
    robot = runs.programs() / "spikeloop-robot"
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        with ros.master(scratch), ros.program(robot, "--step", "--out", scratch / "out"):
            experiment = Experiment()
            early = experiment.step(TICK_NS)
            assert early == {"error": "it was told to advance to 10 ms, and not to begin"}, early
            first = experiment.drive(150)
            times, xs, ys, speeds = zip(*first[0])
            assert times == tuple(range(0, 150 * TICK_NS + 1, 20_000_000)), times
            assert speeds[0] == 0 and abs(speeds[-1] - 0.4) < 0.05, speeds
            moved = ((xs[-1] - xs[0]) ** 2 + (ys[-1] - ys[0]) ** 2) ** 0.5
            assert 0.3 < moved < 0.6, moved  # 1.5 s, less the time to gain speed
            trajectory = finish(experiment, scratch)
            assert experiment.drive(150) == first, "another run from the start"
            assert finish(experiment, scratch) == trajectory
            refusals(experiment)
            answers_again(experiment)
    print(f"stepped by hand over {moved:.2f} m, twice the same")


def finish(experiment, scratch):
    """The path that is complete after `end`."""
    experiment.steps.publish('{"end": true}')
    path = scratch / "out/trajectory.csv"
    ros.until(lambda: path.read_text().count("\n") == 1 + 76, "the last row")
    return path.read_text()


def answers_again(experiment):
    """To a `begin` that is repeated; that of another run is another beginning."""
    for run in (7, 8):
        first = experiment.begin(run=run)
        assert first == {"time_ns": 0, "published": {"/scan": 1, "/odom": 1}}, first
        assert experiment.begin(run=run) == first
        step = experiment.step(TICK_NS)
        assert step == {"time_ns": TICK_NS, "published": {"/scan": 1, "/odom": 1}}, step


def refusals(experiment):
    experiment.begin()
    experiment.step(TICK_NS)
    back = experiment.step(TICK_NS)
    assert back == {"error": "it was told to advance to 10 ms, and stands at 10 ms"}, back
    unread = experiment.ask("go on")
    runs.assert_says(unread["error"], "/spikeloop/step ... 'go on', ")
    for _ in range(3):
        experiment.command(0.1)
    time.sleep(0.5)
    experiment.sent -= 2
    many = experiment.step(2 * TICK_NS)
    assert many == {"error": "1 commands were sent on /cmd_vel, but 3 arrived; look for another "
                             "publisher with  rostopic info /cmd_vel"}, many


if __name__ == "__main__":
    sys.exit(main())
