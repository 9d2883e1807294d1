#!/usr/bin/env python3
"""Builds an instance from arrays, solves it, has it judged, and looks at the plan."""

import numpy as np

import mvtp

# Six robots on a circle change places through its middle, around an obstacle.
angles = np.arange(6) * np.pi / 3
middle = np.array([20.0, 20.0])
out = np.stack([np.cos(angles), np.sin(angles)], axis=1)
starts = np.column_stack([middle + 15 * out, angles + np.pi])
goals = np.column_stack([middle - 15 * out, angles + np.pi])
instance = mvtp.Instance(starts, goals, size=(40, 40), circles=[(20, 20, 1.5)])

plan = mvtp.solve(instance, algorithm="escot", seed=1)
if not plan.solved:
    raise SystemExit(f"not solved: {plan.statistics['reason']}")
print(f"solved: {len(plan)} robots, {plan.poses.shape[1] - 1} steps of {plan.dt} s")
print(f"the referee finds {len(mvtp.validate(instance, plan))} violations")

xy = plan.poses[:, :, :2]  # (n_robots, n_steps, 2)
driven = np.linalg.norm(np.diff(xy, axis=1), axis=2).sum(axis=1)
between = np.linalg.norm(xy[:, None] - xy[None, :], axis=3)[~np.eye(len(plan), dtype=bool)]
print(f"longest path {driven.max():.1f} m; two rear axles came within {between.min():.1f} m")
instance.save("instance.yaml")
plan.save("plan.yaml")  # mvtp view plan.yaml -i instance.yaml -o view.html
