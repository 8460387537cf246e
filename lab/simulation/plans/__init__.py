"""Floor plans of simulated homes, and their structure as meshes."""

from lab.simulation.plans.drawing import DRAWERS
from lab.simulation.plans.plan import FloorPlan, Plan, PlanParams, make_plan

STYLES: tuple[str, ...] = tuple(DRAWERS)

__all__ = ["STYLES", "FloorPlan", "Plan", "PlanParams", "make_plan"]
