"""The operator's page: the guide and the campaign in a browser on the same computer, over a versioned JSON API."""
