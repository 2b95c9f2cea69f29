"""Delivery of alert events: at least once, in order for each alert, without one slow receiver delaying another."""
