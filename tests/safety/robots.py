"""Robots with people beside them that are no part of Spikeloop: they send sensors' messages and hear commands
with the monotonic time of their arrival, over ROS 1 by rospy, over ROS 2 on Fast DDS."""

import contextlib
import os
import pathlib
import subprocess
import sys
import threading
import time
import xmlrpc.client

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "fused"))
import ros  # noqa: E402  (the master, or the domain, of a test's own)
import runs  # noqa: E402, F401


RECENT_S = 0.35  # commands that do not change are repeated ten times a second


class Robot:
    """What both have. `heard`: (time, linear.x) of every command; `sent_at`: when the newest scan left;
    `diagnosis`: (level, text) of the newest message on /diagnostics."""

    def __init__(self):
        self.heard = []
        self.diagnosis = (None, "")
        self.sent_at = 0.0

    def forget(self):
        """A new run begins."""
        self.heard.clear()

    def is_driven(self):
        """By a run whose guard is heard: the run waits for that."""
        now = time.monotonic()
        recent = [value for at, value in self.heard[-3:] if now - at < RECENT_S]
        return len(recent) == 3 and all(recent) and self.is_connected()

    def may_press_stop(self):
        """It is driven by a run that hears the emergency stop."""
        return self.is_driven() and self.is_obeyed()

    def has_moved(self):
        """The first command has come, by whomever."""
        return any(value for _, value in self.heard)

    def last(self):
        return self.heard[-1][1] if self.heard else None

    def time_to_zero_ms(self, begin, patience_s=10):
        end = time.monotonic() + patience_s
        while time.monotonic() < end:
            for at, value in list(self.heard):
                if at > begin and value == 0:
                    return 1e3 * (at - begin)
            time.sleep(0.002)
        return float("inf")

    def has_stopped_since(self, begin):
        return any(at > begin and value == 0 for at, value in self.heard)

    def drives_since(self, begin):
        """What came since then and was no zero."""
        return [value for at, value in self.heard if at > begin and value != 0]

    def time_to_rest_ms(self, begin):
        """Until the first zero since then that no other command has followed."""
        heard = [(at, value) for at, value in self.heard if at > begin]
        driven = max((at for at, value in heard if value != 0), default=begin)
        return min((1e3 * (at - begin) for at, value in heard if at > driven and value == 0), default=float("inf"))


def contact_messages():
    """The classes of gazebo_msgs, which Debian does not have, as genpy makes them."""
    import genpy.dynamic
    from geometry_msgs.msg import Vector3, Wrench
    from std_msgs.msg import Header
    line = "\n" + 80 * "=" + "\n"
    state = """MSG: gazebo_msgs/ContactState
string info
string collision1_name
string collision2_name
geometry_msgs/Wrench[] wrenches
geometry_msgs/Wrench total_wrench
geometry_msgs/Vector3[] contact_positions
geometry_msgs/Vector3[] contact_normals
float64[] depths"""
    parts = [f"MSG: {kind._type}\n{kind._full_text.split('=====')[0]}" for kind in (Header, Wrench, Vector3)]
    text = "std_msgs/Header header\ngazebo_msgs/ContactState[] states"
    made = genpy.dynamic.generate_dynamic("gazebo_msgs/ContactsState", line.join([text, state, *parts]))
    return made["gazebo_msgs/ContactsState"], made["gazebo_msgs/ContactState"]


class Ros1Robot(Robot):
    version = "1"

    def __init__(self):
        super().__init__()
        self._scanning = self._moving = False
        begin = threading.Thread(target=self._begin)
        begin.start()
        begin.join()

    def _begin(self):
        """What it hears late on a busy machine would look like a late stop: its threads are before others, where the
        user may ask for it."""
        with contextlib.suppress(PermissionError):
            os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(os.sched_get_priority_min(os.SCHED_RR)))
        import rospy
        from diagnostic_msgs.msg import DiagnosticArray
        from geometry_msgs.msg import Twist
        from nav_msgs.msg import Odometry
        from sensor_msgs.msg import LaserScan
        from std_msgs.msg import Bool
        rospy.init_node("robot", disable_signals=True, anonymous=True)

        def publisher(topic, kind):
            return rospy.Publisher(topic, kind, queue_size=1, tcp_nodelay=True)
        self._twist, self._bool = Twist, Bool
        self._scans, self._odometry = publisher("/scan", LaserScan), publisher("/odom", Odometry)
        self._stop, self._manual = publisher("/emergency_stop", Bool), publisher("/cmd_vel_manual", Twist)
        self._contacts, self._contact = contact_messages()
        self._bumper = publisher("/bumper_states", self._contacts)
        self._subscribe = lambda: rospy.Subscriber("/cmd_vel", Twist, self._take, tcp_nodelay=True)
        self._commands = self._subscribe()
        rospy.Subscriber("/diagnostics", DiagnosticArray, self._take_diagnosis)
        self._scan = LaserScan(range_min=0.1, range_max=4.1, ranges=[3.0] * 10)
        self._pose = Odometry()
        threading.Thread(target=self._send, daemon=True).start()

    def _take(self, message):
        self.heard.append((time.monotonic(), message.linear.x))

    def _take_diagnosis(self, message):
        status, = message.status
        values = "".join(f"{pair.key} {pair.value}, " for pair in status.values)
        self.diagnosis = (status.level, f"{status.name}: {status.message} ({values})")

    def _send(self):
        while True:
            if self._scanning:
                self.sent_at = time.monotonic()
                self._scans.publish(self._scan)
            if self._moving:
                self._odometry.publish(self._pose)
            time.sleep(0.02)

    def scans(self, on):
        self._scanning = on

    def odometry(self, on):
        self._moving = on

    def forget(self):
        """Removes nodes that were killed from the master, as `rosnode cleanup` does, and subscribes again. A subscriber of
        rospy tries to reach such a node for ever, and ignores a new publisher whose port is that of one of them."""
        super().forget()
        import rosgraph
        master = rosgraph.Master("/robot")
        for topic, names in master.getSystemState()[0]:
            for name in names:
                with contextlib.suppress(rosgraph.MasterException):  # it leaves meanwhile
                    uri = master.lookupNode(name)
                    try:
                        xmlrpc.client.ServerProxy(uri).getPid("/robot")
                    except OSError:
                        rosgraph.Master(name).unregisterPublisher(topic, uri)
        self._commands.unregister()
        self._commands = self._subscribe()

    def is_connected(self):
        return True  # a run begins when it is

    is_obeyed = is_connected

    def press_stop(self, pressed):
        self._stop.publish(self._bool(pressed))

    def drive_by_hand(self, speed):
        message = self._twist()
        message.linear.x = speed
        self._manual.publish(message)

    def touch(self, things):
        names = [str(thing) for thing in range(1, things + 1)]
        self._bumper.publish(self._contacts(states=[
            self._contact(collision1_name="chassis", collision2_name=name) for name in names]))

    def end(self):
        pass


# When Fast DDS knows a subscriber on Cyclone DDS, that one may not know it yet.
MUTUAL_S = 1.5


class Ros2Robot(Robot):
    """fastdds_robot, led line by line."""

    version = "2"

    def __init__(self, program):
        super().__init__()
        self._heard_since = float("inf")  # by the run's process
        self._drivers = 0  # its process was met, and the guard
        self._done = threading.Semaphore(0)
        self._process = subprocess.Popen([program, os.environ["ROS_DOMAIN_ID"]], text=True,
                                         stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        assert self._process.stdout.readline() == "ready\n", "fastdds_robot does not start"
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self):
        for line in self._process.stdout:
            what, at, value, *text = line.split(maxsplit=3)
            if what == "scan":
                self.sent_at = float(at)
            elif what == "done":
                self._done.release()
            elif what == "button":
                self._heard_since = float(at)
            elif what == "driver":
                self._drivers += 1
            elif what == "diagnosis":
                self.diagnosis = (int(value), text[0])
            else:
                self.heard.append((float(at), float(value)))

    def _lead(self, word, value):
        self._process.stdin.write(f"{word} {value}\n")
        self._process.stdin.flush()
        assert self._done.acquire(timeout=60), f"fastdds_robot does not take '{word} {value}'"

    def scans(self, on):
        self._lead("scans", int(on))

    def odometry(self, on):
        self._lead("odometry", int(on))

    def is_connected(self):
        return self._drivers >= 2

    def is_obeyed(self):
        return time.monotonic() - self._heard_since > MUTUAL_S

    def forget(self):
        super().forget()
        self._heard_since, self._drivers = float("inf"), 0

    def press_stop(self, pressed):
        self._lead("stop", int(pressed))

    def drive_by_hand(self, speed):
        self._lead("manual", speed)

    def touch(self, things):
        self._lead("touch", things)

    def end(self):
        self._process.stdin.close()
        self._process.wait(30)


@contextlib.contextmanager
def robot(version, programs, scratch):
    """A robot over this version of ROS, where nobody else is.
    @param programs the directory of Spikeloop's, beside that of the tests'"""
    with ros.place(version, scratch):
        made = Ros1Robot() if version == "1" else Ros2Robot(programs.parent / "tests/bin/fastdds_robot")
        try:
            yield made
        finally:
            made.end()
