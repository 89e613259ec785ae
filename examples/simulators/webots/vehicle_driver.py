"""The vehicle's wheels and odometry: a plug-in of webots_ros2_driver (vehicle.urdf names it).

Takes /cmd_vel (geometry_msgs/Twist); publishes /odom (nav_msgs/Odometry) and odom to base_link on /tf,
50 times a simulated second. Pose and attitude are Webots' own, in the world's frame.
"""
import math

WHEEL_SEPARATION_M = 0.26
WHEEL_RADIUS_M = 0.08
MAX_SPEED_M_S = 1.0
MAX_YAW_RATE_RAD_S = 3.0
COMMAND_TIMEOUT_S = 0.5  # simulated; then the vehicle stops by itself
ODOMETRY_PERIOD_S = 0.02


def limited(value, limit):
    """`value` between -limit and limit; 0 when it is not a finite number."""
    return max(-limit, min(limit, value)) if math.isfinite(value) else 0.0


def wheel_speeds(speed_m_s, yaw_rate_rad_s):
    """Left and right wheel in rad/s, for a speed ahead and a yaw rate (counterclockwise)."""
    speed = limited(speed_m_s, MAX_SPEED_M_S)
    rim = limited(yaw_rate_rad_s, MAX_YAW_RATE_RAD_S) * WHEEL_SEPARATION_M / 2
    return (speed - rim) / WHEEL_RADIUS_M, (speed + rim) / WHEEL_RADIUS_M


def body_velocity(before, now, seconds):
    """Speed ahead (m/s) and yaw rate (rad/s) between two poses (x, y, heading) `seconds` apart."""
    turn = math.remainder(now[2] - before[2], 2 * math.pi)
    middle = before[2] + turn / 2
    ahead = (now[0] - before[0]) * math.cos(middle) + (now[1] - before[1]) * math.sin(middle)
    return ahead / seconds, turn / seconds


class VehicleDriver:
    """What webots_ros2_driver calls: init once, step after every step of the world."""

    def init(self, webots_node, properties):
        import rclpy  # only where Webots runs: the functions above need no ROS
        from geometry_msgs.msg import TransformStamped, Twist
        from nav_msgs.msg import Odometry
        from tf2_msgs.msg import TFMessage

        self.rclpy, self.Odometry = rclpy, Odometry
        self.TransformStamped, self.TFMessage = TransformStamped, TFMessage
        self.robot = webots_node.robot
        step_ms = int(self.robot.getBasicTimeStep())
        self.wheels = [self.robot.getDevice(name) for name in ("wheel_left", "wheel_right")]
        for wheel in self.wheels:
            wheel.setPosition(float("inf"))
            wheel.setVelocity(0.0)
        self.position = self.robot.getDevice("position")
        self.attitude = self.robot.getDevice("attitude")
        self.position.enable(step_ms)
        self.attitude.enable(step_ms)
        self.commanded_s = -math.inf
        self.command = None
        self.reported_s = 0.0
        self.pose = None

        rclpy.init(args=None)
        self.node = rclpy.create_node("vehicle_driver")
        self.node.create_subscription(Twist, "/cmd_vel", self.take, 1)
        self.odometry = self.node.create_publisher(Odometry, "/odom", 10)
        self.frames = self.node.create_publisher(TFMessage, "/tf", 10)

    def take(self, command):
        self.command = command
        self.commanded_s = self.robot.getTime()

    def step(self):
        self.rclpy.spin_once(self.node, timeout_sec=0)
        now = self.robot.getTime()
        fresh = now - self.commanded_s <= COMMAND_TIMEOUT_S
        speeds = wheel_speeds(self.command.linear.x, self.command.angular.z) if fresh else (0.0, 0.0)
        for wheel, speed in zip(self.wheels, speeds):
            wheel.setVelocity(speed)
        if now - self.reported_s >= ODOMETRY_PERIOD_S - 1e-6:
            self.report(now)

    def report(self, now):
        x, y, z = self.position.getValues()
        heading = self.attitude.getRollPitchYaw()[2]
        if not math.isfinite(x + y + z + heading):
            return  # the sensors have no value in the first step
        pose = (x, y, heading)
        velocity = (0.0, 0.0)
        if self.pose:
            velocity = body_velocity(self.pose, pose, now - self.reported_s)
        self.pose, self.reported_s = pose, now

        message = self.Odometry()
        stamp = message.header.stamp
        stamp.sec, stamp.nanosec = divmod(round(now * 1e9), 10**9)
        message.header.frame_id = "odom"
        message.child_frame_id = "base_link"
        place, turn = message.pose.pose.position, message.pose.pose.orientation
        place.x, place.y, place.z = x, y, z
        turn.z, turn.w = math.sin(heading / 2), math.cos(heading / 2)
        message.twist.twist.linear.x, message.twist.twist.angular.z = velocity
        self.odometry.publish(message)

        frame = self.TransformStamped(header=message.header, child_frame_id="base_link")
        frame.transform.translation.x, frame.transform.translation.y = x, y
        frame.transform.translation.z = z
        frame.transform.rotation = turn
        self.frames.publish(self.TFMessage(transforms=[frame]))
