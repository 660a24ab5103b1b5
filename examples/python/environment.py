"""The example rover as an environment for Gymnasium: it drives to a goal.

Needs urdf2fmu and gymnasium. `python environment.py ../rover.urdf` lets a simple controller drive.
"""

import sys

import gymnasium
import numpy as np

import urdf2fmu

STEP = 0.05
"""s, between two actions"""


class Drive(gymnasium.Env):
    """Action: speeds of the left and right wheels as shares of the fastest. Observation: the goal in the rover's
    frame (m), and its forward and turning speeds (m/s, rad/s)."""

    fastest = 8.0
    """rad/s"""
    wheels = "cmd.left_*_wheel_joint.velocity", "cmd.right_*_wheel_joint.velocity"

    def __init__(self, robot, seconds=10.0):
        self.robot = urdf2fmu.Simulation(robot)
        self.steps = round(seconds / STEP)
        self.action_space = gymnasium.spaces.Box(-1, 1, (2,), np.float32)
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (4,), np.float32)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.robot.reset()
        angle = self.np_random.uniform(-np.pi, np.pi)
        self.goal = self.np_random.uniform(0.5, 1.5) * np.array([np.cos(angle), np.sin(angle)])
        self.taken = 0
        return self.observe(), {}

    def step(self, action):
        before = self.distance()
        for name, share in zip(self.wheels, np.clip(action, -1, 1)):
            self.robot[name] = self.fastest * float(share)
        self.robot.step(STEP)
        self.taken += 1
        arrived = self.distance() < 0.1
        reward = before - self.distance() + (1.0 if arrived else 0.0)
        return self.observe(), float(reward), bool(arrived), self.taken >= self.steps, {}

    def distance(self):
        """m"""
        return np.linalg.norm(self.goal - self.robot["base.position"][:2])

    def observe(self):
        yaw = self.robot["base.rpy.yaw"]
        to_base = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
        goal = to_base @ (self.goal - self.robot["base.position"][:2])
        speed = to_base @ self.robot["base.linear_velocity"][:2]
        return np.array([*goal, speed[0], self.robot["base.angular_velocity.z"]], np.float32)

    def close(self):
        self.robot.close()


def drive(observation):
    """Turns towards the goal and drives there."""
    x, y, *_ = observation
    turn = np.clip(2.0 * np.arctan2(y, x), -1, 1)
    ahead = max(0.0, np.cos(np.arctan2(y, x)))
    return np.array([ahead - turn, ahead + turn])


def main():
    environment = Drive(sys.argv[1])
    for seed in range(5):
        observation, _ = environment.reset(seed=seed)
        total, ended = 0.0, False
        while not ended:
            observation, reward, arrived, late, _ = environment.step(drive(observation))
            total, ended = total + reward, arrived or late
        print(f"goal {seed}: {'reached' if arrived else 'missed'} after {environment.taken * STEP:.2f} s, "
              f"reward {total:.2f}")
    environment.close()


if __name__ == "__main__":
    main()
