"""The api service: the map over REST, events and a dashboard. It owns nothing and asks the others."""
